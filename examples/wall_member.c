/* A host in C that owns the frame: Newmark's average acceleration with the wall as a member, here
 * with fuses and a tendon that yields. Its events end steps early; velocities after impacts follow
 * from the momentum over the host's mass. The program compares with the wall that steps by itself
 * and fails unless the difference falls with the square of the step. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "rwmf.h"

static const char *text = "&wall h = 2.0, b = 0.5, m_w = 2.0e4 /\n"
                          "&frame T_s = 0.5, gamma = 5.0, xi_s = 0.05 /\n"
                          "&fuse eta_y = 0.3, stroke_y = 0.01, hardening = 0.02 /\n"
                          "&cable eta_0 = 0.3, eta_alpha = 5.0, eta_y = 0.8, hardening = 0.02 /\n"
                          "&impact rule = 'coupled' /\n"
                          "&solver method = 'dop853', rtol = 1e-10, t_end = 1.2 /\n";

static const double m = 1.0e5, c = 2 * 0.05 * 12.566370614359172 * 1.0e5,
                    k = 157.91367041742973 * 1.0e5; /* of the frame: kg, N s/m, N/m */
static char message[256];

static void check(int status) {
   if (status == 0) return;
   fprintf(stderr, "rwmf: %s\n", message);
   exit(1);
}

/* Ground acceleration: straight lines between samples at 20 ms. */
static double sample(int i) { return i < 50 ? 7 * sin(8 * 0.02 * i) : 0; }
static double ground(double t) {
   const int i = (int)floor(t / 0.02 + 1e-9);
   return sample(i) + (t / 0.02 - i) * (sample(i + 1) - sample(i));
}

/* Acceleration of the mass at given displacement and velocity, or at the end of a step of average
 * acceleration from `x` of length h: Newton's method with the tangents of the member. */
static void solve(rwmf_member *wall, int side, double t, double h, const double x[3],
                  double end[3]) {
   for (int i = 0; i < 50; i++) {
      const double a[2] = {ground(t + h), 0};
      double f, tangents[3];
      end[1] = x[1] + h / 2 * (x[2] + end[2]);
      end[0] = x[0] + h / 2 * (x[1] + end[1]);
      check(rwmf_respond_member(wall, end, a, &f, tangents, NULL, message, sizeof message));
      if (side == 0) { /* the base holds the mass */
         end[0] = end[1] = end[2] = 0;
         return;
      }
      const double rest = f + m * (end[2] + a[0]) + c * end[1] + k * end[0];
      const double change = rest / (tangents[2] + m + h / 2 * (tangents[1] + c) +
                                    h * h / 4 * (tangents[0] + k));
      end[2] -= change;
      if (fabs(change) < 1e-11 * (1 + fabs(end[2]))) return;
   }
   exit(2);
}

/* Advance from t over dt; count the impacts. */
static void step(rwmf_member *wall, double t, double dt, double x[3], int *impacts) {
   const double zero[1] = {0};
   rwmf_member_info info;
   rwmf_member_event event;
   int32_t rests;
   for (double left = dt; left > 1e-12;) {
      double motions[6] = {x[0], x[1], x[2], x[0], x[1], x[2]};
      double *end = motions + 3, h = left;
      check(rwmf_query_member(wall, &info, message, sizeof message));
      for (int i = 0; i < 20; i++) {
         const double a[4] = {ground(t), 0, ground(t + h), 0}, push[2] = {-m * a[0], -m * a[2]};
         solve(wall, info.side, t, h, x, end);
         if (i == 0) {
            check(rwmf_next_member_event(wall, h, motions, a, push, 1, &event, message,
                                         sizeof message));
            if (event.kind == 0) break;
            h = event.tau;
            if (event.kind == RWMF_EVENT_LIFT_OFF && h <= 0) break;
         } else if (event.kind != RWMF_EVENT_IMPACT || fabs(end[0]) < 1e-10) {
            break;
         } else {
            h -= end[0] / end[1]; /* onto the base */
         }
      }
      check(rwmf_commit_member(wall, message, sizeof message));
      t += h;
      left -= h;
      for (int i = 0; i < 3; i++) x[i] = end[i];
      if (event.kind == RWMF_EVENT_IMPACT) {
         const double a[2] = {ground(t), 0};
         x[0] = 0;
         ++*impacts;
         check(rwmf_land_member(wall, zero, &m, &x[1], &info.side, message, sizeof message));
         check(rwmf_member_settles(wall, dt, x, a, -m * a[0], &m, &rests, message, sizeof message));
         if (rests) {
            check(rwmf_place_member(wall, 0, message, sizeof message));
            x[1] = x[2] = 0;
         }
      } else if (event.kind == RWMF_EVENT_LIFT_OFF) {
         check(rwmf_place_member(wall, event.side, message, sizeof message));
      }
      if (event.kind != 0) {
         check(rwmf_query_member(wall, &info, message, sizeof message));
         solve(wall, info.side, t, 0, x, x);
         check(rwmf_revert_member(wall, message, sizeof message));
      }
   }
}

int main(void) {
   double last = 0;
   for (double dt = 0.004; dt > 0.0004; dt /= 2) {
      rwmf_member *wall = NULL;
      rwmf_wall *kernel = NULL;
      rwmf_state state;
      double x[3] = {0, 0, 0}, worst = 0, top = 0;
      int impacts = 0;
      check(rwmf_create_member(text, &wall, message, sizeof message));
      check(rwmf_create(text, 0, 7, &kernel, message, sizeof message));
      for (int i = 0; i < 60; i++) {
         const double t[2] = {0.02 * i, 0.02 * (i + 1)}, a[2] = {sample(i), sample(i + 1)};
         for (double part = 0; part < 0.02 - 1e-9; part += dt)
            step(wall, t[0] + part, dt, x, &impacts);
         check(rwmf_advance_samples(kernel, 2, t, a, message, sizeof message));
         check(rwmf_query_state(kernel, &state, message, sizeof message));
         worst = fmax(worst, fabs(x[0] - state.u_s));
         top = fmax(top, fabs(state.u_s));
      }
      printf("step %.4f s: difference from the kernel %.2e of %.4f m, %d impacts\n", dt, worst, top,
             impacts);
      rwmf_destroy(&kernel);
      rwmf_destroy_member(&wall);
      if (last > 0 && worst > 0.4 * last) return 3;
      last = worst;
   }
   return last < 1e-5 ? 0 : 4;
}
