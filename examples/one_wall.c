/* A host in C: a case that is read once, a wall of it that steps under samples and under a function,
 * a step that is taken back, and the wall as an element. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "rwmf.h"

static const char *text = "&wall h = 2.0, b = 0.5, m_w = 2.0e4 /\n"
                          "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
                          "&impact rule = 'coupled' /\n"
                          "&model formulation = 'exact' /\n"
                          "&solver method = 'dop853', t_end = 2.0 /\n";

static char message[256];

/* Every call is checked: a status, and a line for a person. */
static void check(int status) {
   if (status != 0) {
      fprintf(stderr, "rwmf: %s\n", message);
      exit(1);
   }
}

static double pulse(double t, void *data) { return *(double *)data * sin(6 * t); }

int main(void) {
   const double dt = 0.02;
   double amplitude = 4;
   char version[32];
   rwmf_case *scene = NULL;
   rwmf_wall *wall = NULL;
   rwmf_snapshot *before = NULL;
   rwmf_element *element = NULL;
   rwmf_state state;
   rwmf_forces forces;
   rwmf_response response;
   rwmf_event events[8];
   size_t count, impacts = 0;

   rwmf_version(version, sizeof version);
   check(rwmf_read_case(text, NULL, &scene, message, sizeof message));
   check(rwmf_create_from_case(scene, 0, amplitude, &wall, message, sizeof message));
   for (int i = 0; i < 90; i++) {
      const double t[2] = {i * dt, (i + 1) * dt};
      const double trial[2] = {0, 9};
      check(rwmf_save(wall, &before, message, sizeof message));
      check(rwmf_advance_samples(wall, 2, t, trial, message, sizeof message));
      check(rwmf_restore(wall, before, message, sizeof message));
      check(rwmf_advance_ground(wall, t[1], pulse, &amplitude, message, sizeof message));
      check(rwmf_query_events(wall, 8, events, &count, message, sizeof message));
      for (size_t k = 0; k < count && k < 8; k++)
         impacts += events[k].kind == RWMF_EVENT_IMPACT;
   }
   check(rwmf_query_state(wall, &state, message, sizeof message));
   check(rwmf_query_forces(wall, &forces, message, sizeof message));
   if (impacts != (size_t)state.impacts) return 2;

   /* The element answers with the link's force to the motion that the wall made. */
   check(rwmf_create_element_from_case(scene, &element, message, sizeof message));
   rwmf_destroy_case(&scene);
   check(rwmf_respond(element, state.theta > 0 ? 1 : -1, state.u_s, state.u_s_dot, state.u_s_ddot,
                      pulse(state.t, &amplitude), &response, message, sizeof message));
   if (fabs(response.force + forces.link) > 1e-9 * fabs(forces.link)) return 3;

   /* A bad call says so and changes nothing. */
   if (rwmf_advance(wall, 0.1, message, sizeof message) != RWMF_INPUT) return 4;
   printf("rwmf %s: u_s = %.6f m, link force %.1f N, %zu impacts\n", version, state.u_s, forces.link,
          impacts);
   printf("a bad call: %s\n", message);

   rwmf_destroy_element(&element);
   rwmf_destroy_snapshot(&before);
   rwmf_destroy(&wall);
   rwmf_destroy(&wall);
   return rwmf_advance(wall, 3, NULL, 0) == RWMF_INPUT ? 0 : 5;
}
