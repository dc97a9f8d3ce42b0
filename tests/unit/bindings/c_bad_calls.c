/* Every function of rwmf.h with every pointer NULL and every real that is no number, or of no
 * possible size: refused, with a message, and everything is as it was. The same calls with what is
 * allowed succeed, and leave no message of an earlier one. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rwmf.h"

static const char *text = "&wall h = 2.0, b = 0.5, m_w = 1.0e4 /\n"
                          "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
                          "&cable eta_0 = 1.0 /\n"
                          "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"
                          "&model formulation = 'exact' /\n"
                          "&solver method = 'dop853', t_end = 0.1 /\n";

static const char *const none = NULL;
static const char *const path = "bad_calls.nml";
static char message[512];
static int failures = 0;

/* What a call is made of: its pointers and its reals, in the order of the header. */
static const void *p[7];
static double x[6];

/* What is looked at, and what a call may make or fill. */
static rwmf_case *scene, *made_case;
static rwmf_wall *wall, *made_wall;
static rwmf_element *element, *made_element;
static rwmf_member *member, *made_member, *spare;
static rwmf_snapshot *saved, *made_snapshot;
static union {
   rwmf_result result;
   rwmf_state state;
   rwmf_forces forces;
   rwmf_response response;
   rwmf_member_info info;
   rwmf_member_response member_response;
   rwmf_member_event member_event;
   rwmf_event events[2];
   double tau;
   double rows[2];
} room;
static rwmf_ending ending;
static int32_t row_status[2];
static size_t count;
static double acceleration;

#define TALK message, sizeof message

static void expect(int is_true, const char *function, const char *what, double number) {
   if (is_true) return;
   failures++;
   printf("%s, %s %g: not so (message: %s)\n", function, what, number, message);
}

static double ground(double t, void *data) {
   (void)t;
   return data ? *(double *)data : acceleration;
}

static int run(void) { return rwmf_run(p[0], (void *)p[1], TALK); }
static int read_case(void) { return rwmf_read_case(p[0], p[2], (void *)p[1], TALK); }
static int read_case_file(void) { return rwmf_read_case_file(p[0], (void *)p[1], TALK); }
static int run_case(void) { return rwmf_run_case(p[0], (void *)p[1], TALK); }
static int run_case_ending(void) {
   return rwmf_run_case_ending(p[0], (void *)p[1], (void *)p[2], TALK);
}
static int run_rows(void) {
   const rwmf_rows rows = {1, p[2], 2, p[3] ? x : NULL, 1, p[4]};
   return rwmf_run_rows(p[0], p[1] ? &rows : NULL, 1, (void *)p[5], (void *)p[6], TALK);
}
static int create_from_case(void) {
   return rwmf_create_from_case(p[0], x[0], x[1], (void *)p[1], TALK);
}
static int create_element_from_case(void) {
   return rwmf_create_element_from_case(p[0], (void *)p[1], TALK);
}
static int create(void) { return rwmf_create(p[0], x[0], x[1], (void *)p[1], TALK); }
static int create_element(void) { return rwmf_create_element(p[0], (void *)p[1], TALK); }
static int advance(void) { return rwmf_advance((void *)p[0], x[0], TALK); }
static int advance_samples(void) {
   return rwmf_advance_samples((void *)p[0], 2, p[1] ? x : NULL, p[2] ? x + 2 : NULL, TALK);
}
static int advance_ground(void) {
   acceleration = x[1];
   return rwmf_advance_ground((void *)p[0], x[0], p[1] ? ground : NULL, (void *)p[2], TALK);
}
static int query_state(void) { return rwmf_query_state(p[0], (void *)p[1], TALK); }
static int query_ending(void) { return rwmf_query_ending(p[0], (void *)p[1], TALK); }
static int query_forces(void) { return rwmf_query_forces(p[0], (void *)p[1], TALK); }
static int query_events(void) {
   return rwmf_query_events(p[0], 2, (void *)p[1], (void *)p[2], TALK);
}
static int save(void) { return rwmf_save((void *)p[0], (void *)p[1], TALK); }
static int restore(void) { return rwmf_restore((void *)p[0], p[1], TALK); }
static int respond(void) {
   return rwmf_respond(p[0], 1, x[0], x[1], x[2], x[3], (void *)p[1], TALK);
}
/* A member of one degree of freedom: its numbers are those of x, its ground and its push zero. */
static const double zeros[4] = {0};
static double derivative;
static int create_member(void) { return rwmf_create_member(p[0], (void *)p[1], TALK); }
static int create_member_from_case(void) {
   return rwmf_create_member_from_case(p[0], (void *)p[1], TALK);
}
static int query_member(void) { return rwmf_query_member(p[0], (void *)p[1], TALK); }
static int respond_member(void) {
   return rwmf_respond_member((void *)p[0], p[1] ? x : NULL, p[2] ? x + 3 : NULL, (void *)p[3],
                              (void *)p[4], (void *)p[5], TALK);
}
static int commit_member(void) { return rwmf_commit_member((void *)p[0], TALK); }
static int revert_member(void) { return rwmf_revert_member((void *)p[0], TALK); }
static int restart_member(void) { return rwmf_restart_member((void *)p[0], TALK); }
static int copy_member(void) { return rwmf_copy_member(p[0], (void *)p[1], TALK); }
static int query_links(void) {
   return rwmf_query_links(p[0], p[1] ? x : NULL, (void *)p[2], (void *)p[3], TALK);
}
static int next_member_event(void) {
   const double motions[6] = {x[1], x[2], x[3], x[1], x[2], x[3]};
   return rwmf_next_member_event(p[0], x[0], p[1] ? motions : NULL, p[2], p[3], 1, (void *)p[4],
                                 TALK);
}
static int land_member(void) {
   rwmf_copy_member(member, &spare, NULL, 0);
   rwmf_place_member(spare, 1, NULL, 0);
   return rwmf_land_member(p[0] ? spare : NULL, p[1] ? x : NULL, p[2], p[3] ? x + 1 : NULL,
                           (void *)p[4], TALK);
}
static int member_settles(void) {
   return rwmf_member_settles(p[0], x[0], p[1] ? x + 1 : NULL, p[2], x[4], p[3], (void *)p[4],
                              TALK);
}
static int place_member(void) {
   rwmf_copy_member(member, &spare, NULL, 0);
   return rwmf_place_member(p[0] ? spare : NULL, 1, TALK);
}
/* These have an answer in place of a status: 0 here for every answer that is one. */
static int velocity_factor(void) { return isnan(rwmf_velocity_factor(p[0])) ? RWMF_INPUT : 0; }
static int next_impact(void) {
   int answer = rwmf_next_impact(1, x[0], x[1], x[2], x[3], x[4], (void *)p[0]);
   return answer == 0 || answer == 1 ? 0 : answer;
}
static int next_lift_off(void) {
   int answer = rwmf_next_lift_off(p[0], x[0], x[1], x[2], x[3], x[4], (void *)p[1]);
   return abs(answer) <= 1 ? 0 : answer;
}
static int settles(void) {
   int answer = rwmf_settles(p[0], x[0], x[1], x[2], x[3], x[4]);
   return answer == 0 || answer == 1 ? 0 : answer;
}

/* A function: its pointers with those that may be NULL (a bit each), and its reals with those that
 * must not be negative. */
typedef struct {
   const char *name;
   int (*call)(void);
   int speaks; /* it has a message */
   int n_pointers;
   const void *pointers[7];
   unsigned may_be_null;
   int n_reals;
   double reals[5];
   unsigned not_negative;
} function;

static void forget_what_was_made(void) {
   rwmf_destroy_case(&made_case);
   rwmf_destroy(&made_wall);
   rwmf_destroy_element(&made_element);
   rwmf_destroy_member(&made_member);
   rwmf_destroy_snapshot(&made_snapshot);
}

static int call(const function *f) {
   int status;
   strcpy(message, "of an earlier call");
   status = f->call();
   return status;
}

static void prepare(const function *f) {
   memcpy(p, f->pointers, sizeof f->pointers);
   memcpy(x, f->reals, sizeof f->reals);
   forget_what_was_made();
   rwmf_restore(wall, saved, NULL, 0);
}

/* The call has to be refused; the wall and what a call would have filled have to be as before. */
static void refuse(const function *f, const char *what, double number) {
   rwmf_state before, after;
   unsigned char filled[sizeof room], bytes[sizeof room];

   rwmf_query_state(wall, &before, NULL, 0);
   memset(&room, 77, sizeof room);
   memcpy(filled, &room, sizeof room);
   ending.t = -7;
   count = 77;
   row_status[0] = row_status[1] = 77;
   expect(call(f) == RWMF_INPUT, f->name, what, number);
   if (f->speaks)
      expect(message[0] != '\0' && strcmp(message, "of an earlier call") != 0, f->name,
             "says why", number);
   memcpy(bytes, &room, sizeof room);
   expect(memcmp(filled, bytes, sizeof room) == 0, f->name, "fills nothing", number);
   expect(ending.t == -7 && count == 77 && row_status[0] == 77 && row_status[1] == 77, f->name,
          "fills nothing beside", number);
   expect(!made_case && !made_wall && !made_element && !made_member && !made_snapshot, f->name,
          "makes nothing", number);
   rwmf_query_state(wall, &after, NULL, 0);
   expect(before.t == after.t && before.u_s == after.u_s && before.steps == after.steps, f->name,
          "leaves the wall alone", number);
}

static void try_function(const function *f) {
   const double bad[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
   int i;
   size_t k;

   prepare(f);
   expect(call(f) == 0, f->name, "what is allowed", 0);
   if (f->speaks) expect(message[0] == '\0', f->name, "no message after a success", 0);
   for (i = 0; i < f->n_pointers; i++) {
      prepare(f);
      p[i] = NULL;
      if (f->may_be_null >> i & 1)
         expect(call(f) == 0, f->name, "may be NULL", i);
      else
         refuse(f, "pointer NULL", i);
   }
   for (i = 0; i < f->n_reals; i++) {
      for (k = 0; k < sizeof bad / sizeof bad[0]; k++) {
         prepare(f);
         x[i] = bad[k];
         refuse(f, "real", bad[k]);
      }
      prepare(f);
      x[i] = -0.25;
      if (f->not_negative >> i & 1)
         refuse(f, "real", x[i]);
      else
         expect(call(f) == 0, f->name, "may be negative", i);
   }
   forget_what_was_made();
}

static void try_functions(void) {
   const char *const column = "frame.T_s", *const quantity = "overturned";
   /* the wall stands at 0.5 s: an earlier time is refused as well */
   const function functions[] = {
      {"run", run, 1, 2, {text, &room}, 0, 0, {0}, 0},
      {"read_case", read_case, 1, 3, {text, &made_case, none}, 4, 0, {0}, 0},
      {"read_case_file", read_case_file, 1, 2, {path, &made_case}, 0, 0, {0}, 0},
      {"run_case", run_case, 1, 2, {scene, &room}, 0, 0, {0}, 0},
      {"run_case_ending", run_case_ending, 1, 3, {scene, &room, &ending}, 0, 0, {0}, 0},
      {"run_rows", run_rows, 1, 7, {scene, text, &column, text, &quantity, &room, row_status}, 0, 2,
       {1.0, 2.0}, 0},
      {"create_from_case", create_from_case, 1, 2, {scene, &made_wall}, 0, 2, {0, 1}, 0},
      {"create_element_from_case", create_element_from_case, 1, 2, {scene, &made_element}, 0, 0,
       {0}, 0},
      {"create", create, 1, 2, {text, &made_wall}, 0, 2, {0, 1}, 0},
      {"create_element", create_element, 1, 2, {text, &made_element}, 0, 0, {0}, 0},
      {"query_state", query_state, 1, 2, {wall, &room}, 0, 0, {0}, 0},
      {"query_ending", query_ending, 1, 2, {wall, &ending}, 0, 0, {0}, 0},
      {"query_forces", query_forces, 1, 2, {wall, &room}, 0, 0, {0}, 0},
      {"query_events", query_events, 1, 3, {wall, &room, &count}, 0, 0, {0}, 0},
      {"save", save, 1, 2, {wall, &made_snapshot}, 0, 0, {0}, 0},
      {"restore", restore, 1, 2, {wall, saved}, 0, 0, {0}, 0},
      {"advance", advance, 1, 1, {wall}, 0, 1, {0.5}, 1},
      {"advance_samples", advance_samples, 1, 3, {wall, text, text}, 0, 4, {0.5, 0.6, 1, -1}, 3},
      {"advance_ground", advance_ground, 1, 3, {wall, text, none}, 4, 2, {0.7, 1}, 1},
      {"respond", respond, 1, 2, {element, &room}, 0, 4, {0.1, -0.5, 2, 1}, 0},
      {"create_member", create_member, 1, 2, {text, &made_member}, 0, 0, {0}, 0},
      {"create_member_from_case", create_member_from_case, 1, 2, {scene, &made_member}, 0, 0, {0},
       0},
      {"query_member", query_member, 1, 2, {member, &room}, 0, 0, {0}, 0},
      {"respond_member", respond_member, 1, 6, {member, text, text, &room, none, none}, 48, 4,
       {0.1, -0.5, 2, 1}, 0},
      {"commit_member", commit_member, 1, 1, {member}, 0, 0, {0}, 0},
      {"revert_member", revert_member, 1, 1, {member}, 0, 0, {0}, 0},
      {"restart_member", restart_member, 1, 1, {member}, 0, 0, {0}, 0},
      {"copy_member", copy_member, 1, 2, {member, &made_member}, 0, 0, {0}, 0},
      {"query_links", query_links, 1, 4, {member, text, &room, &derivative}, 0, 3,
       {0.1, -0.5, 2}, 0},
      {"next_member_event", next_member_event, 1, 5, {member, text, zeros, zeros, &room}, 0, 4,
       {0.1, 0.1, -0.5, 2}, 1},
      {"land_member", land_member, 1, 5, {member, text, none, text, &row_status}, 4, 2, {0, -1}, 0},
      {"member_settles", member_settles, 1, 5, {member, text, zeros, none, &row_status}, 8, 5,
       {0.01, 0, -1e-3, 0, 0}, 1},
      {"place_member", place_member, 1, 1, {member}, 0, 0, {0}, 0},
      {"velocity_factor", velocity_factor, 0, 1, {element}, 0, 0, {0}, 0},
      {"next_impact", next_impact, 0, 1, {&room}, 0, 5, {0.02, 0.009, -0.5, -0.001, -0.5}, 1},
      {"next_lift_off", next_lift_off, 0, 2, {element, &room}, 0, 5, {0.02, 0, 1e5, 0, 0}, 1},
      {"settles", settles, 0, 1, {element}, 0, 5, {0.02, 1e-6, 0, 0, 5e4}, 17},
   };
   size_t i;
   for (i = 0; i < sizeof functions / sizeof functions[0]; i++) try_function(functions + i);
}

/* What is no real and no pointer: numbers of samples and of events, sides, the destroyers. */
static void try_the_rest(void) {
   const double t[2] = {0.5, 0.6};
   const size_t n[] = {0, 1, SIZE_MAX, (size_t)1 << 33};
   rwmf_response response;
   double tau = 0;
   size_t i;
   int side;

   for (i = 0; i < sizeof n / sizeof n[0]; i++)
      expect(rwmf_advance_samples(wall, n[i], t, t, TALK) == RWMF_INPUT, "advance_samples", "n",
             (double)n[i]);
   rwmf_version(NULL, 10);
   rwmf_destroy(NULL);
   rwmf_destroy_case(NULL);
   rwmf_destroy_element(NULL);
   rwmf_destroy_member(NULL);
   rwmf_destroy_snapshot(NULL);
   for (side = -3; side <= 3; side++) {
      int is_side = side == 1 || side == -1;
      expect(rwmf_respond(element, side, 0, 0, 0, 0, &response, TALK)
                == (is_side ? 0 : RWMF_INPUT), "respond", "side", side);
      expect((rwmf_next_impact(side, 0.1, 0, 0, 0, 0, &tau) == RWMF_INPUT) == !is_side,
             "next_impact", "side", side);
   }
   /* a host that only counts has no room */
   expect(rwmf_query_events(wall, 0, NULL, &count, TALK) == 0, "query_events", "only counts", 0);
   expect(rwmf_query_events(wall, SIZE_MAX, NULL, &count, TALK) == RWMF_INPUT, "query_events",
          "room that is nowhere", 0);
}

int main(void) {
   FILE *file = fopen(path, "w");

   fputs(text, file);
   fclose(file);
   expect(rwmf_read_case(text, NULL, &scene, TALK) == 0, "read_case", "begins", 0);
   expect(rwmf_create_from_case(scene, 0, 0, &wall, TALK) == 0, "create", "begins", 0);
   expect(rwmf_advance(wall, 0.5, TALK) == 0, "advance", "begins", 0.5);
   expect(rwmf_save(wall, &saved, TALK) == 0, "save", "begins", 0);
   expect(rwmf_create_element_from_case(scene, &element, TALK) == 0, "element", "begins", 0);
   expect(rwmf_create_member_from_case(scene, &member, TALK) == 0, "member", "begins", 0);
   try_functions();
   try_the_rest();
   rwmf_destroy_member(&spare);
   rwmf_destroy_member(&member);
   rwmf_destroy_snapshot(&saved);
   rwmf_destroy_element(&element);
   rwmf_destroy(&wall);
   rwmf_destroy_case(&scene);
   remove(path);
   if (failures > 0) printf("%d failures\n", failures);
   return failures != 0;
}
