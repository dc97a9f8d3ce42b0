/* Many cases in one call: a table whose rows are runs of one case, each with its own numbers. */
#include <stdio.h>
#include <stdlib.h>

#include "rwmf.h"

enum { N_ROWS = 200, N_COLUMNS = 3, N_QUANTITIES = 2 };

static const char *text = "&wall h = 2.0, b = 0.5 /\n"
                          "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
                          "&cable eta_0 = 1.0 /\n"
                          "&impact rule = 'coupled' /\n"
                          "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"
                          "&model formulation = 'exact' /\n"
                          "&solver method = 'dop853', t_end = 5.0 /\n";

static char message[256];

static void check(int status) {
   if (status != 0) {
      fprintf(stderr, "rwmf: %s\n", message);
      exit(1);
   }
}

int main(void) {
   const char *const columns[N_COLUMNS] = {"wall.b", "cable.eta_0", "scale"};
   const char *const quantities[N_QUANTITIES] = {"u_s_max_m", "theta_max_over_alpha"};
   double values[N_ROWS][N_COLUMNS], results[N_ROWS][N_QUANTITIES], largest = 0;
   int32_t status[N_ROWS];
   rwmf_case *scene = NULL;
   const rwmf_rows rows = {N_COLUMNS, columns, N_ROWS, values[0], N_QUANTITIES, quantities};
   int ok = 0;

   for (int i = 0; i < N_ROWS; i++) {
      values[i][0] = 0.3 + 0.002 * (i + 1); /* m */
      values[i][1] = 0.01 * (i + 1);
      values[i][2] = 1 + 0.005 * (i + 1);
   }
   check(rwmf_read_case(text, NULL, &scene, message, sizeof message));
   check(rwmf_run_rows(scene, &rows, 0, results[0], status, message, sizeof message));
   rwmf_destroy_case(&scene);
   for (int i = 0; i < N_ROWS; i++) {
      if (status[i] == RWMF_ROW_OK) ok++;
      if (results[i][0] > largest) largest = results[i][0];
   }
   printf("%d of %d rows: u_s_max up to %.6f m\n", ok, N_ROWS, largest);
   return ok == N_ROWS ? 0 : 2;
}
