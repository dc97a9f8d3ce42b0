/* A host in C that prints what it gets, bit by bit: host KIND CASE.nml. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rwmf.h"

enum { STEPS = 100, MOST_EVENTS = 64 };
static const double dt = 0.02;

static char message[512];

/* Print the status of a call and return it. */
static int told(const char *name, int status) {
   printf("%s: status %d\n", name, status);
   return status;
}

static double pulse(double t, void *data) { return *(double *)data * sin(6 * t); }

static char *read_text(const char *path) {
   FILE *file = fopen(path, "rb");
   char *text;
   long size;
   if (file == NULL) exit(3);
   fseek(file, 0, SEEK_END);
   size = ftell(file);
   rewind(file);
   text = calloc((size_t)size + 1, 1);
   if (text == NULL || fread(text, 1, (size_t)size, file) != (size_t)size) exit(3);
   fclose(file);
   return text;
}

static void simulate(const char *text) {
   rwmf_result r;
   if (told("rwmf_run", rwmf_run(text, &r, message, sizeof message)) != 0) return;
   printf("%a %a %a %a %a\n", r.u_s_max, r.theta_max, r.theta_dot_max, r.cable_increment_max,
          r.t_end);
   printf("%lld %lld %lld %d\n", (long long)r.impacts, (long long)r.lift_offs, (long long)r.steps,
          (int)r.overturned);
}

/* State, forces and events of a wall that steps. */
static void show(const rwmf_wall *wall) {
   rwmf_state s;
   rwmf_forces f;
   rwmf_event events[MOST_EVENTS];
   size_t count;
   int status = rwmf_query_state(wall, &s, message, sizeof message);
   if (status == 0) status = rwmf_query_forces(wall, &f, message, sizeof message);
   if (status == 0)
      status = rwmf_query_events(wall, MOST_EVENTS, events, &count, message, sizeof message);
   if (status != 0) {
      told("query", status);
      return;
   }
   printf("%a %a %a %a %a %a %a %a %a\n", s.t, s.theta, s.theta_dot, s.theta_ddot, s.u_s, s.u_s_dot,
          s.u_s_ddot, s.u_s_max, s.theta_max);
   printf("%lld %lld %lld %d %d\n", (long long)s.impacts, (long long)s.lift_offs,
          (long long)s.steps, (int)s.at_rest, (int)s.overturned);
   printf("%a %a %a\n", f.link, f.frame_shear, f.cable);
   for (size_t i = 0; i < count && i < MOST_EVENTS; i++)
      printf("event %d %a %a %a\n", (int)events[i].kind, events[i].t, events[i].theta,
             events[i].theta_dot);
}

/* Under samples, a function and the case's own motion in turn; every step is tried first. */
static void step(const char *text) {
   rwmf_wall *wall = NULL;
   rwmf_snapshot *before = NULL;
   double amplitude = 4;
   if (told("rwmf_create", rwmf_create(text, 0, amplitude, &wall, message, sizeof message)) != 0)
      return;
   for (int i = 0; i < STEPS; i++) {
      const double t[2] = {i * dt, (i + 1) * dt};
      const double a[2] = {amplitude * sin(6 * t[0]), amplitude * sin(6 * t[1])};
      const double trial[2] = {0, 9};
      int status = rwmf_save(wall, &before, message, sizeof message);
      if (status == 0) status = rwmf_advance_samples(wall, 2, t, trial, message, sizeof message);
      if (status == 0) status = rwmf_restore(wall, before, message, sizeof message);
      if (status != 0) told("trial", status);
      if (i / 10 % 3 == 0)
         status = rwmf_advance_samples(wall, 2, t, a, message, sizeof message);
      else if (i / 10 % 3 == 1)
         status = rwmf_advance_ground(wall, t[1], pulse, &amplitude, message, sizeof message);
      else
         status = rwmf_advance(wall, t[1], message, sizeof message);
      if (status != 0) {
         told("advance", status);
         rwmf_advance(wall, t[1], message, sizeof message);
      }
      show(wall);
   }
   rwmf_destroy_snapshot(&before);
   rwmf_destroy(&wall);
}

static void respond(const char *text) {
   rwmf_element *element = NULL;
   rwmf_response r;
   double tau = 0;
   if (told("rwmf_create_element", rwmf_create_element(text, &element, message, sizeof message)) != 0)
      return;
   printf("velocity factor %a\n", rwmf_velocity_factor(element));
   for (int i = 1; i <= 12; i++) {
      const int side = 1 - 2 * (i % 2);
      const int status = rwmf_respond(element, side, side * 0.03 * (i - 1), 0.4 - 0.1 * i,
                                      2.0 - 0.3 * i, 1.0, &r, message, sizeof message);
      if (told("rwmf_respond", status) == 0)
         printf("%a %a %a %a %a %a %a %a\n", r.force, r.stiffness, r.damping, r.mass, r.theta,
                r.theta_dot, r.theta_ddot, r.cable);
      printf("impact %d", rwmf_next_impact(side, dt, side * 0.001 * i, -side * 0.5, -side * 0.002,
                                           -side * 0.3, &tau));
      printf(" %a, settles %d\n", tau,
             rwmf_settles(element, dt, pow(10, -i), 0.1, 0.2, 5.0));
   }
   for (int i = -3; i <= 3; i++) {
      printf("lift-off %d", rwmf_next_lift_off(element, dt, 0, 4.0 * i, 0, 1.0 * i, &tau));
      printf(" %a\n", tau);
   }
   rwmf_destroy_element(&element);
}

int main(int count, char **words) {
   char *text;
   if (count != 3) return 2;
   text = read_text(words[2]);
   if (strcmp(words[1], "simulate") == 0) simulate(text);
   if (strcmp(words[1], "stepping") == 0) step(text);
   if (strcmp(words[1], "element") == 0) respond(text);
   free(text);
   return 0;
}
