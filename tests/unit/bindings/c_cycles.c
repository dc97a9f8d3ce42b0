/* A host program that runs for a long time, and one with threads: 100,000 cycles of trial steps of a
 * wall, an element and a member leave every state bit by bit and no byte of memory behind; walls,
 * elements and members of one case in four threads have the bits of one thread. */
#include <malloc.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rwmf.h"

enum { CYCLES = 100000, FIRST = 100, THREADS = 4, MOST = 8, SLACK = 1024 };

#define SOLVER                                                                                     \
   "&motion kind = 'one_sine', a_max_g = 0.7, omega_p = 8.0 /\n"                                   \
   "&model formulation = 'exact' /\n"                                                              \
   "&solver method = 'dop853', rtol = 1e-8, t_end = 2.0 /\n"
#define WALL "&wall h = 2.0, b = 0.5, m_w = 2.0e4 /\n&impact rule = 'coupled' /\n"
#define CABLE "&cable eta_0 = 1.0, eta_alpha = 5.0, eta_y = 1.2, hardening = 0.02 /\n"
#define FUSE "&fuse eta_y = 0.3, stroke_y = 0.01, law = 'flag', flag_height = 0.9 /\n"
#define STOREYS                                                                                    \
   "&frame xi_s = 0.05 /\n&storeys m_over_m_w = 2.5, 2.0, k_over_m_w = 800.0, 600.0, "             \
   "height = 2.0, 2.0, coupling = 'springs', k_link_over_m_w = 4e3, 6e3 /\n"
#define DEVICES                                                                                    \
   "&damper c_over_m_w = 0.5 /\n&inerter inertance_over_m_w = 1.0 /\n&vertical ratio = 0.5 /\n"

static const char *const wall_text = WALL "&frame T_s = 0.5, gamma = 5.0, xi_s = 0.05 /\n" CABLE FUSE
   DEVICES SOLVER;
static const char *const element_text = WALL "&frame gamma = 5.0 /\n"
   "&cable eta_0 = 1.0, eta_alpha = 5.0 /\n&damper c_over_m_w = 0.5 /\n" SOLVER;
static const char *const member_text = WALL STOREYS CABLE FUSE DEVICES
   "&bending EI_over_m_w = 5000.0, modes = 2 /\n" SOLVER;

/* The handles of one thread. */
typedef struct {
   rwmf_wall *wall;
   rwmf_snapshot *snapshot;
   rwmf_element *element;
   rwmf_member *member, *copy;
   int n;
   char message[512];
} host_t;

/* Results of a cycle. */
typedef struct {
   rwmf_state state;
   rwmf_forces forces;
   rwmf_response response;
   rwmf_member_response at, back;
   double force[MOST], tangents[3 * MOST * MOST];
} answer_t;

static rwmf_case *scene = NULL, *member_scene = NULL;

#define TALK host->message, sizeof host->message
#define ASK(call)                                                                                  \
   if ((call) != 0) return printf("line %d: %s\n", __LINE__, host->message), 1

static int create(host_t *host) {
   rwmf_member_info info;

   memset(host, 0, sizeof *host);
   ASK(rwmf_create_from_case(scene, 0.0, 7.0, &host->wall, TALK));
   ASK(rwmf_advance(host->wall, 0.6, TALK));
   ASK(rwmf_save(host->wall, &host->snapshot, TALK));
   ASK(rwmf_create_element(element_text, &host->element, TALK));
   ASK(rwmf_create_member_from_case(member_scene, &host->member, TALK));
   ASK(rwmf_place_member(host->member, 1, TALK));
   ASK(rwmf_query_member(host->member, &info, TALK));
   host->n = info.dofs;
   return host->n > MOST || host->n < 3;
}

static void destroy(host_t *host) {
   rwmf_destroy(&host->wall);
   rwmf_destroy_snapshot(&host->snapshot);
   rwmf_destroy_element(&host->element);
   rwmf_destroy_member(&host->member);
   rwmf_destroy_member(&host->copy);
}

/* Trial steps whose sizes change with i, and the way back; the answers do not depend on i. */
static int cycle(host_t *host, int i, answer_t *answer) {
   const double size = 1.0 + 0.1 * (i % 7), ground[2] = {0.5, 0.0};
   const double t[2] = {0.6, 0.6 + 1e-3 * size}, a[2] = {1.0, size};
   double trial[3 * MOST] = {0}, motion[3 * MOST] = {0};
   rwmf_state tried;

   motion[0] = 0.05;
   trial[0] = 0.05 + 0.02 * size;
   ASK(rwmf_advance_samples(host->wall, 2, t, a, TALK));
   ASK(rwmf_query_state(host->wall, &tried, TALK));
   ASK(rwmf_restore(host->wall, host->snapshot, TALK));
   ASK(rwmf_query_state(host->wall, &answer->state, TALK));
   ASK(rwmf_query_forces(host->wall, &answer->forces, TALK));
   if (tried.t != t[1] || tried.theta == answer->state.theta) return printf("no trial step\n"), 1;
   if (i % 10 == 0) {
      rwmf_destroy_snapshot(&host->snapshot);
      rwmf_destroy_member(&host->copy);
   }
   ASK(rwmf_save(host->wall, &host->snapshot, TALK));
   ASK(rwmf_respond(host->element, 1, 0.01, 0.1, 0.2, 0.5, &answer->response, TALK));
   ASK(rwmf_copy_member(host->member, &host->copy, TALK));
   ASK(rwmf_respond_member(host->member, trial, ground, answer->force, NULL, &answer->at, TALK));
   ASK(rwmf_revert_member(host->member, TALK));
   ASK(rwmf_respond_member(host->member, motion, ground, answer->force, answer->tangents,
                           &answer->at, TALK));
   ASK(rwmf_commit_member(host->member, TALK));
   ASK(rwmf_respond_member(host->member, motion, ground, answer->force, NULL, &answer->back, TALK));
   ASK(rwmf_copy_member(host->copy, &host->member, TALK));
   return 0;
}

/* Cycles from `first` on; `*answer` is that of the last. 1 when two of them differ. */
static int run(host_t *host, int first, int n, answer_t *answer) {
   answer_t now;

   for (int i = first; i < first + n; i++) {
      memset(&now, 0, sizeof now);
      if (cycle(host, i, &now) != 0) return 1;
      if (i > 0 && memcmp(&now, answer, sizeof now) != 0) return printf("cycle %d differs\n", i), 1;
      *answer = now;
   }
   return 0;
}

/* glibc may give a block up to 16 bytes more than it asks for: SLACK allows for some of them. A block
 * that is lost in each cycle would be 3 MB. */
static size_t bytes_in_use(void) {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
   return mallinfo2().uordblks;
#else
   return 0;
#endif
}

static int test_cycles(int n, answer_t *answer) {
   host_t host;
   size_t before;
   int failures = create(&host) || run(&host, 0, FIRST, answer);

   before = bytes_in_use();
   failures = failures || run(&host, FIRST, n, answer);
   if (bytes_in_use() > before + SLACK) {
      printf("%zu bytes became %zu in %d cycles\n", before, bytes_in_use(), n);
      failures++;
   }
   destroy(&host);
   return failures;
}

typedef struct {
   pthread_t thread;
   answer_t answer;
   int failures;
} worker_t;

static void *work(void *data) {
   worker_t *worker = data;
   host_t host;

   worker->failures = create(&host) || run(&host, 0, FIRST, &worker->answer);
   destroy(&host);
   return NULL;
}

static int test_threads(const answer_t *alone) {
   worker_t workers[THREADS];
   int failures = 0;

   memset(workers, 0, sizeof workers);
   for (int i = 0; i < THREADS; i++)
      if (pthread_create(&workers[i].thread, NULL, work, &workers[i]) != 0) return 1;
   for (int i = 0; i < THREADS; i++) {
      pthread_join(workers[i].thread, NULL);
      failures += workers[i].failures;
      if (memcmp(alone, &workers[i].answer, sizeof *alone) != 0) {
         printf("thread %d differs from one alone\n", i);
         failures++;
      }
   }
   return failures;
}

/* The number of cycles may be given: under valgrind and the sanitizers fewer do. */
int main(int argc, char **argv) {
   const int n = argc > 1 ? atoi(argv[1]) : CYCLES;
   host_t place, *host = &place;
   answer_t answer;
   int failures;

   ASK(rwmf_read_case(wall_text, NULL, &scene, TALK));
   ASK(rwmf_read_case(member_text, NULL, &member_scene, TALK));
   failures = test_cycles(n, &answer);
   failures += test_threads(&answer);
   rwmf_destroy_case(&scene);
   rwmf_destroy_case(&member_scene);
   printf("%d cycles, %d threads: %d failed\n", n, THREADS, failures);
   return failures != 0;
}
