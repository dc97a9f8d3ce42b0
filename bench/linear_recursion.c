/* The exact linear recursion of Nigam and Jennings (1969): spectrum of the bare frame.

   u'' + 2 xi w u' + w^2 u = -a(t), a linear between equal samples, is advanced exactly from sample
   to sample by two 2x2 matrices. Peaks between the samples are exact: where the tangents at both
   ends of an interval allow a value above the largest so far, the root of u' is found.

   Usage: linear_recursion LANES REPEATS T_FIRST T_LAST N XI < RECORD
   LANES is 1 (scalar code), 8 or 32. RECORD: the interval dt [s], then the samples [m/s2].
   Prints the least seconds of all repeats, one thread, then the N peaks [m]. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MOST_LANES 32

/* One interval: u1 = c[0] u0 + c[1] v0 + c[2] a0 + c[3] a1, v1 alike from c[4]. */
typedef struct {
   double c[8];
   double h; /* [s] */
   double w; /* [rad/s] */
   double wd; /* of the damped oscillation [rad/s] */
   double xi;
} law_t;

/* What s seconds do to a free oscillation. */
typedef struct {
   double s; /* [s] */
   double decay;
   double c;
   double d;
} turn_t;

static turn_t turn_of(const law_t *law, double s) {
   const turn_t turn = {s, exp(-law->xi * law->w * s), cos(law->wd * s), sin(law->wd * s)};
   return turn;
}

/* State [m], [m/s] after a turn in an interval that begins with acceleration a, slope b. */
static void propagate(const law_t *law, const turn_t *t, const double *start, double a, double b,
                      double *u, double *v) {
   const double w = law->w, xi = law->xi, wd = law->wd;
   const double line = -b / (w * w);
   const double u_p = -a / (w * w) + 2 * xi * b / (w * w * w);
   const double p = start[0] - u_p;
   const double q = (start[1] - line + xi * w * p) / wd;
   *u = t->decay * (p * t->c + q * t->d) + u_p + line * t->s;
   *v = t->decay * ((wd * q - xi * w * p) * t->c - (wd * p + xi * w * q) * t->d) + line;
}

/* Coefficients of the recursion from the four unit states. */
static law_t make_law(double period, double xi, double h) {
   const double w = 2 * acos(-1.0) / period;
   law_t law = {.h = h, .w = w, .wd = w * sqrt(1 - xi * xi), .xi = xi};
   const turn_t turn = turn_of(&law, h);
   for (int j = 0; j < 4; j++) {
      const double start[2] = {j == 0, j == 1};
      const double a_0 = j == 2, a_1 = j == 3;
      propagate(&law, &turn, start, a_0, (a_1 - a_0) / h, &law.c[j], &law.c[4 + j]);
   }
   return law;
}

/* u'' [m/s2]. */
static double rate(const law_t *law, double u, double v, double a) {
   return -a - law->w * (2 * law->xi * v + law->w * u);
}

/* Fraction of the interval at which the cubic through v and v' at its ends vanishes. */
static double guess(const law_t *law, const double *from, const double *to, double a_0,
                    double a_1) {
   const double d_0 = law->h * rate(law, from[0], from[1], a_0);
   const double d_1 = law->h * rate(law, to[0], to[1], a_1);
   const double change = to[1] - from[1];
   const double c = 3 * change - 2 * d_0 - d_1, d = d_0 + d_1 - 2 * change;
   double x = -from[1] / change;
   for (int i = 0; i < 2; i++)
      x -= (from[1] + x * (d_0 + x * (c + x * d))) / (d_0 + x * (2 * c + x * 3 * d));
   return x;
}

/* Largest |u| inside an interval whose velocity changes its sign. */
static double peak_inside(const law_t *law, const double *from, const double *to, double a_0,
                          double a_1) {
   const double b = (a_1 - a_0) / law->h, sign = from[1] > 0 ? 1 : -1;
   double low = 0, high = law->h, s = law->h * guess(law, from, to, a_0, a_1), u, v;
   if (!(s > low && s < high)) s = 0.5 * law->h;
   for (int i = 0; i < 60; i++) {
      const turn_t turn = turn_of(law, s);
      propagate(law, &turn, from, a_0, b, &u, &v);
      if (sign * v > 0) low = s; else high = s;
      double next = s - v / rate(law, u, v, a_0 + b * s);
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      /* what is left is a parabola, to the third power of its length */
      if (fabs(next - s) < 1e-4 * law->h) return fabs(u + 0.5 * v * (next - s));
      s = next;
   }
   return fabs(u);
}

/* Several intervals a sample where the period is short, so that one interval has one peak. */
static int intervals_a_sample(double period, double h) {
   const int n = (int)ceil(8 * h / period);
   return n < 1 ? 1 : n;
}

/* The record with `parts` intervals for one; the same linear motion. */
typedef struct {
   int n;
   int parts;
   double h;
   double *a;
} record_t;

static void refine(const record_t *given, int parts, record_t *fine) {
   if (fine->parts == parts) return;
   fine->parts = parts;
   fine->n = (given->n - 1) * parts + 1;
   fine->h = given->h / parts;
   free(fine->a);
   fine->a = malloc(sizeof(double) * (size_t)fine->n);
   if (fine->a == NULL) exit(1);
   for (int i = 0; i < fine->n; i++) {
      const int k = i / parts, j = i % parts;
      const double *a = given->a + k;
      fine->a[i] = j == 0 ? a[0] : a[0] + (a[1] - a[0]) * j / parts;
   }
}

#define MARGIN 0.25

static inline double larger(double a, double b) { return a > b ? a : b; }

/* Largest |u| that an interval between two states can reach, with room for the forcing: a curve of
   one curvature stays below both of its end tangents. */
static inline double bound(double h, double u, double v, double u_1, double v_1) {
   const double left = fabs(u) + h * fabs(v), right = fabs(u_1) + h * fabs(v_1);
   return (left < right ? left : right) + MARGIN * h * fabs(v - v_1);
}

static double scalar(const record_t *r, double period, double xi) {
   const law_t law = make_law(period, xi, r->h);
   const double *c = law.c;
   double u = 0, v = 0, most = 0;
   for (int i = 0; i + 1 < r->n; i++) {
      const double a_0 = r->a[i], a_1 = r->a[i + 1];
      const double u_1 = (c[2] * a_0 + c[3] * a_1) + (c[0] * u + c[1] * v);
      const double v_1 = (c[6] * a_0 + c[7] * a_1) + (c[4] * u + c[5] * v);
      const double from[2] = {u, v}, to[2] = {u_1, v_1};
      if (v * v_1 < 0 && bound(r->h, u, v, u_1, v_1) > most)
         most = larger(most, peak_inside(&law, from, to, a_0, a_1));
      most = larger(most, fabs(u_1));
      u = u_1;
      v = v_1;
   }
   return most;
}

/* Eight periods in one variable: a register with AVX-512, several without. */
typedef double v8 __attribute__((vector_size(64)));
typedef int64_t mask8 __attribute__((vector_size(64)));

static inline v8 magnitude(v8 x) { return (v8)((mask8)x & INT64_MAX); }

/* Intervals that the lanes advance between two looks for peaks. */
#define RUN 16

/* Exact peaks of a run of one lane. */
static double peak_of_run(const law_t *law, const double *a, int n, const v8 *u, const v8 *v,
                          int stride, int lane, double most) {
   for (int i = 0; i < n; i++) {
      const double from[2] = {u[i * stride][lane], v[i * stride][lane]};
      const double to[2] = {u[(i + 1) * stride][lane], v[(i + 1) * stride][lane]};
      if (from[1] * to[1] < 0 && bound(law->h, from[0], from[1], to[0], to[1]) > most)
         most = larger(most, peak_inside(law, from, to, a[i], a[i + 1]));
      most = larger(most, fabs(to[0]));
   }
   return most;
}

/* The same for 8 VECTORS periods in lockstep. The loop only notes whether the tangent of any
   interval reaches above the largest value; such runs are looked through afterwards. */
#define BLOCK(VECTORS)                                                                            \
   static void block_##VECTORS(const record_t *r, const law_t *law, double *peak) {               \
      v8 c[8][VECTORS], u[RUN + 1][VECTORS], v[RUN + 1][VECTORS], most[VECTORS];                  \
      memset(c, 0, sizeof c);                                                                     \
      memset(u, 0, sizeof u);                                                                     \
      memset(v, 0, sizeof v);                                                                     \
      memset(most, 0, sizeof most);                                                               \
      for (int k = 0; k < 8; k++)                                                                 \
         for (int l = 0; l < 8 * VECTORS; l++) c[k][l / 8][l % 8] = law[l].c[k];                  \
      for (int first = 0; first + 1 < r->n; first += RUN) {                                       \
         const double *a = r->a + first, h = r->h;                                                \
         const int n = r->n - 1 - first < RUN ? r->n - 1 - first : RUN;                           \
         mask8 open[VECTORS] = {0};                                                               \
         for (int i = 0; i < n; i++) {                                                            \
            for (int k = 0; k < VECTORS; k++) {                                                   \
               const v8 x = u[i][k], y = v[i][k];                                                 \
               const v8 y_1 = (c[6][k] * a[i] + c[7][k] * a[i + 1]) + (c[4][k] * x + c[5][k] * y);\
               u[i + 1][k] = (c[2][k] * a[i] + c[3][k] * a[i + 1]) + (c[0][k] * x + c[1][k] * y); \
               v[i + 1][k] = y_1;                                                                 \
               open[k] |= magnitude(x) + h * magnitude(y) + (MARGIN * h) * magnitude(y - y_1)     \
                          > most[k];                                                              \
            }                                                                                     \
         }                                                                                        \
         for (int l = 0; l < 8 * VECTORS; l++)                                                    \
            if (open[l / 8][l % 8])                                                               \
               most[l / 8][l % 8] = peak_of_run(&law[l], a, n, &u[0][l / 8], &v[0][l / 8],        \
                                                VECTORS, l % 8, most[l / 8][l % 8]);              \
         memcpy(u[0], u[n], sizeof u[0]);                                                         \
         memcpy(v[0], v[n], sizeof v[0]);                                                         \
      }                                                                                           \
      for (int l = 0; l < 8 * VECTORS; l++) peak[l] = most[l / 8][l % 8];                         \
   }

BLOCK(1)
BLOCK(4)

/* Peaks of all periods, which ascend. Periods of a block share the interval; its last lanes repeat
   the last period. */
static void spectrum(int lanes, const record_t *given, int count, const double *period, double xi,
                     double *peak) {
   record_t fine = {.a = NULL};
   for (int first = 0, next; first < count; first = next) {
      law_t law[MOST_LANES];
      double found[MOST_LANES];
      const int parts = intervals_a_sample(period[first], given->h);
      refine(given, parts, &fine);
      next = first + 1;
      if (lanes == 1) {
         peak[first] = scalar(&fine, period[first], xi);
         continue;
      }
      while (next < count && next - first < lanes
             && intervals_a_sample(period[next], given->h) == parts) next++;
      for (int l = 0; l < lanes; l++)
         law[l] = make_law(period[first + l < next ? first + l : next - 1], xi, fine.h);
      if (lanes == 8) block_1(&fine, law, found); else block_4(&fine, law, found);
      memcpy(peak + first, found, sizeof(double) * (size_t)(next - first));
   }
   free(fine.a);
}

static double seconds(void) {
   struct timespec now;
   timespec_get(&now, TIME_UTC);
   return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
   if (argc != 7) {
      fprintf(stderr, "usage: linear_recursion LANES REPEATS T_FIRST T_LAST N XI < RECORD\n");
      return 2;
   }
   const int lanes = atoi(argv[1]), repeats = atoi(argv[2]), count = atoi(argv[5]);
   const double first = atof(argv[3]), last = atof(argv[4]), xi = atof(argv[6]);
   if ((lanes != 1 && lanes != 8 && lanes != 32) || repeats < 1 || count < 1 || first <= 0) {
      fprintf(stderr, "LANES must be 1, 8 or 32; REPEATS, N and T_FIRST positive\n");
      return 2;
   }
   int room = 1024;
   double value, least = 1e99;
   record_t record = {.a = malloc(sizeof(double) * (size_t)room)};
   double *period = malloc(sizeof(double) * (size_t)count);
   double *peak = malloc(sizeof(double) * (size_t)count);
   if (record.a == NULL || period == NULL || peak == NULL || scanf("%lf", &record.h) != 1) return 1;
   while (scanf("%lf", &value) == 1) {
      if (record.n == room) {
         double *more = realloc(record.a, sizeof(double) * (size_t)(room *= 2));
         if (more == NULL) return 1;
         record.a = more;
      }
      record.a[record.n++] = value;
   }
   for (int k = 0; k < count; k++)
      period[k] = count > 1 ? first + (last - first) * k / (count - 1) : first;
   for (int i = 0; i < repeats; i++) {
      const double begin = seconds();
      spectrum(lanes, &record, count, period, xi, peak);
      least = fmin(least, seconds() - begin);
   }
   printf("%.9e\n", least);
   for (int k = 0; k < count; k++) printf("%.17g\n", peak[k]);
   free(record.a);
   free(period);
   free(peak);
   return 0;
}
