/* The rows of a table in C: each has the bits of its own case, run alone; what cannot be run, and
 * what is refused. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "rwmf.h"

enum { N_COLUMNS = 4, N_ROWS = 11, N_QUANTITIES = 3 };

static const char *format = "&wall h = 2.0, b = %.17g /\n"
                            "&frame T_s = %.17g, gamma = %.17g, xi_s = 0.05 /\n"
                            "&impact rule = 'constant', e = 0.9 /\n"
                            "&motion kind = 'sine', a_max_g = %.17g, T_p = 0.6, cycles = 4 /\n"
                            "&model formulation = 'exact' /\n"
                            "&solver method = 'dop853', t_end = 4.0, max_steps = 2000 /\n";
static const char *const columns[] = {"T_s", "wall.b", "motion.a_max_g", "frame.gamma"};
static const char *const quantities[] = {"u_s_max_m", "theta_dot_max_rad_s", "impacts"};

static char message[512];
static int failures = 0;

static void expect(int is_true, const char *what, int row) {
   if (is_true) return;
   failures++;
   printf("not so: %s, row %d (message: %s)\n", what, row, message);
}

#define TALK message, sizeof message

/* A call that has to be refused, with a message that holds some words. */
static void refuse(int status, const char *words) {
   expect(status == RWMF_INPUT && strstr(message, words) != NULL, words, -1);
   message[0] = '\0';
}

static rwmf_case *read_scene(double b, double T_s, double gamma, double a_max_g) {
   rwmf_case *scene = NULL;
   char text[1024];

   snprintf(text, sizeof text, format, b, T_s, gamma, a_max_g);
   expect(rwmf_read_case(text, NULL, &scene, TALK) == 0, "reads", -1);
   return scene;
}

static void fill_values(double *values) {
   for (int i = 0; i < N_ROWS; i++) {
      double *row = values + N_COLUMNS * i;
      row[0] = 0.4 + 0.13 * i;
      row[1] = 0.5 + 0.01 * i;
      row[2] = 0.5 - 0.02 * i;
      row[3] = 2.0 + 0.3 * i;
   }
}

/* A row has the numbers of its case, run alone. */
static void compare_with_single_run(const double *row, const double *results, int i) {
   rwmf_case *scene = read_scene(row[1], row[0], row[3], row[2]);
   rwmf_result alone;

   expect(rwmf_run_case(scene, &alone, TALK) == 0, "runs alone", i);
   expect(results[0] == alone.u_s_max && results[1] == alone.theta_dot_max
             && results[2] == (double)alone.impacts, "bits of a single run", i);
   rwmf_destroy_case(&scene);
}

static void test_same_bits(void) {
   rwmf_case *scene = read_scene(0.5, 1.0, 5.0, 0.4);
   double values[N_ROWS * N_COLUMNS], one[N_ROWS * N_QUANTITIES], two[N_ROWS * N_QUANTITIES + 1];
   int32_t status[N_ROWS + 1];
   rwmf_rows rows = {N_COLUMNS, columns, N_ROWS, values, N_QUANTITIES, quantities};

   fill_values(values);
   two[N_ROWS * N_QUANTITIES] = -7;
   status[N_ROWS] = 77;
   expect(rwmf_run_rows(scene, &rows, 1, one, status, TALK) == 0 && message[0] == '\0', "runs", -1);
   for (int i = 0; i < N_ROWS; i++) {
      expect(status[i] == RWMF_ROW_OK, "status", i);
      compare_with_single_run(values + N_COLUMNS * i, one + N_QUANTITIES * i, i);
   }
   expect(rwmf_run_rows(scene, &rows, 2, two, status, TALK) == 0, "runs in two threads", -1);
   expect(memcmp(one, two, sizeof one) == 0, "bits in two threads", -1);
   expect(two[N_ROWS * N_QUANTITIES] == -7 && status[N_ROWS] == 77, "nothing beyond the room", -1);
   rows.n = 1;
   rows.values = values + N_COLUMNS * 6;
   expect(rwmf_run_rows(scene, &rows, 0, two, status, TALK) == 0, "runs one", -1);
   expect(memcmp(one + N_QUANTITIES * 6, two, N_QUANTITIES * sizeof two[0]) == 0,
          "bits without company", 6);
   rwmf_destroy_case(&scene);
}

/* Run `n` rows of five columns that report two quantities. What has no result is NaN. */
static void run_five(const char *text, const char *const *names, size_t n, const double *values,
                     int32_t *status, double *results) {
   const char *const keys[] = {"theta_max_over_alpha", "overturned"};
   const rwmf_rows rows = {5, names, n, values, 2, keys};
   rwmf_case *scene = NULL;

   expect(rwmf_read_case(text, NULL, &scene, TALK) == 0, "reads", -1);
   expect(rwmf_run_rows(scene, &rows, 2, results, status, TALK) == 0, "runs five columns", -1);
   for (size_t i = 0; i < n; i++) {
      int is_run = status[i] < RWMF_ROW_REFUSED;
      expect(isnan(results[2 * i]) == !is_run && isnan(results[2 * i + 1]) == !is_run, "NaN", (int)i);
      expect(!is_run || results[2 * i + 1] == (status[i] == RWMF_ROW_OVERTURNED), "yes", (int)i);
   }
   rwmf_destroy_case(&scene);
}

/* Each status has its number, and the rows beside go on. */
static void test_status(void) {
   const char *text = "&wall h = 2.0, b = 0.2 /\n"
                      "&frame T_s = 1.0, gamma = 0.5, xi_s = 0.05 /\n"
                      "&p_delta m_g_over_m_s = 1.0 /\n"
                      "&motion kind = 'one_sine', a_max_g = 0.2, T_p = 0.8 /\n"
                      "&model formulation = 'exact' /\n"
                      "&solver method = 'adams', t_end = 4.0 /\n";
   const char *block = "&wall h = 2.0, b = 0.2 /\n"
                       "&motion kind = 'one_sine', a_max_g = 0.2, T_p = 0.8 /\n"
                       "&solver method = 'dop853', t_end = 4.0 /\n";
   const char *const names[] = {"scale", "b", "p_delta.drift_limit", "solver.max_steps",
                                "solver.accuracy"};
   const char *const of_block[] = {"scale", "b", "wall.h", "solver.max_steps", "solver.rtol"};
   /* the last six ask for the digits that round-off takes, not from each of them */
   const double values[][5] = {{1, 0.2, 9, 1e5, 0.01},       {1, 0.2, 1e-4, 1e5, 0.01},
                               {1, -0.2, 9, 1e5, 0.01},      {1, 0.2, 9, 3, 0.01},
                               {1, 0.2, 9, 1e5, 0.01},       {3, 0.2, 9, 1e5, 6.1e-14},
                               {3, 0.3, 9, 1e5, 6.1e-14},    {3, 0.05, 9, 1e5, 6.1e-14},
                               {4, 0.05, 9, 1e5, 6.1e-14},   {4, 0.1, 9, 1e5, 6.1e-14},
                               {4, 0.2, 9, 1e5, 6.1e-14}};
   const double blocks[][5] = {{0.8, 0.2, 2, 1e5, 1e-9}, {5, 0.2, 2, 1e5, 1e-9}};
   const int32_t expected[] = {RWMF_ROW_OK, RWMF_ROW_COLLAPSED, RWMF_ROW_REFUSED, RWMF_ROW_FAILED,
                               RWMF_ROW_OK};
   double results[22];
   int32_t status[11];
   int inaccurate = 0;

   run_five(text, names, 11, values[0], status, results);
   for (int i = 0; i < 5; i++) expect(status[i] == expected[i], "status", i);
   expect(results[0] > 0 && results[0] == results[8], "the first and the last", -1);
   for (int i = 5; i < 11; i++) {
      inaccurate += status[i] == RWMF_ROW_INACCURATE;
      expect(status[i] == RWMF_ROW_INACCURATE || status[i] == RWMF_ROW_OK, "accuracy", i);
   }
   expect(inaccurate > 0, "round-off", -1);
   run_five(block, of_block, 2, blocks[0], status, results);
   expect(status[0] == RWMF_ROW_OK && status[1] == RWMF_ROW_OVERTURNED, "a block overturns", -1);
}

/* Sizes, names and numbers that are refused; c_bad_calls tries NULL and what is no number. */
static void test_refused(void) {
   const char *const bad_columns[] = {"T_s", "wall.width", "wall", NULL, "T_s", "cable.eta_0"};
   const char *const words[] = {"", "width", "group.key", "the name of a column is NULL", "twice",
                                "no group &cable"};
   const char *names[] = {"T_s", NULL}, *keys[] = {"u_s_max_m", NULL};
   const size_t sizes[] = {0, SIZE_MAX, (size_t)1 << 31};
   double values[] = {1, 0.5, 1, NAN}, results[4] = {-7, -7, -7, -7};
   int32_t status[2] = {77, 77};
   rwmf_case *scene = read_scene(0.5, 1.0, 5.0, 0.4);
   rwmf_rows good = {2, names, 2, values, 1, keys}, rows;

   for (int i = 1; i < 6; i++) {
      names[1] = bad_columns[i];
      refuse(rwmf_run_rows(scene, &good, 1, results, status, TALK),
             i == 1 ? "values: row 1, wall.width = " : words[i]);
      values[3] = 0.6;
      refuse(rwmf_run_rows(scene, &good, 1, results, status, TALK), words[i]);
   }
   names[1] = "b";
   for (int i = 0; i < 3; i++) {
      rows = good;
      rows.n = sizes[i];
      refuse(rwmf_run_rows(scene, &rows, 1, results, status, TALK), "the number of rows must be");
      rows = good;
      rows.n_columns = sizes[i];
      refuse(rwmf_run_rows(scene, &rows, 1, results, status, TALK), "the number of columns must");
      rows = good;
      rows.n_quantities = sizes[i];
      refuse(rwmf_run_rows(scene, &rows, 1, results, status, TALK), "the number of quantities");
   }
   refuse(rwmf_run_rows(scene, &good, -1, results, status, TALK), "threads = -1");
   good.n_quantities = 2;
   refuse(rwmf_run_rows(scene, &good, 1, results, status, TALK), "the key of a quantity is NULL");
   keys[1] = "drift";
   refuse(rwmf_run_rows(scene, &good, 1, results, status, TALK), "drift does not apply");
   expect(results[0] == -7 && results[3] == -7 && status[0] == 77 && status[1] == 77,
          "everything as before", -1);
   keys[1] = "impacts";
   expect(rwmf_run_rows(scene, &good, 1, results, status, TALK) == 0, "what is allowed", -1);
   expect(rwmf_run_rows(scene, &good, 1, results, status, NULL, 0) == 0, "nobody asks", -1);
   rwmf_destroy_case(&scene);
}

/* A frame that leaves its period to `&spectrum` needs a column for it. */
static void test_no_period(void) {
   const char *text = "&frame xi_s = 0.05 /\n"
                      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"
                      "&solver method = 'dop853', t_end = 1 /\n&spectrum T_s = 1 /\n";
   const char *const keys[] = {"u_s_max_m"};
   const char *const periods[] = {"T_s", "frame.T_s"}, *const other[] = {"frame.xi_s"};
   const double values[] = {0.7, 0.8};
   double one[2], two[2];
   int32_t status[2];
   rwmf_case *scene = NULL;
   rwmf_rows rows = {1, periods, 2, values, 1, keys};

   expect(rwmf_read_case(text, NULL, &scene, TALK) == 0, "reads a spectrum", -1);
   expect(rwmf_run_rows(scene, &rows, 1, one, status, TALK) == 0, "period of a row", -1);
   expect(one[0] > 0 && one[1] > 0, "has displacements", -1);
   rows.columns = periods + 1;
   expect(rwmf_run_rows(scene, &rows, 1, two, status, TALK) == 0, "period as a key", -1);
   expect(one[0] == two[0] && one[1] == two[1], "is the same", -1);
   rows.columns = other;
   refuse(rwmf_run_rows(scene, &rows, 1, two, status, TALK), "the key T_s is missing");
   rwmf_destroy_case(&scene);
}

int main(void) {
   test_same_bits();
   test_status();
   test_refused();
   test_no_period();
   return failures != 0;
}
