/* A foreign program in C: one simulation, and another two of a case that is read once. */
#include <stdio.h>

#include <rwmf.h>

int main(void) {
   char message[256];
   const char *text = "&wall h = 2.0, b = 0.5 /\n"
                      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
                      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"
                      "&model formulation = 'exact' /\n"
                      "&solver t_end = 3.0 /\n";
   rwmf_result result, again;
   rwmf_case *scene = NULL;
   int status = rwmf_run(text, &result, message, sizeof message);
   if (status == 0) status = rwmf_read_case(text, NULL, &scene, message, sizeof message);
   for (int i = 0; i < 2 && status == 0; i++) {
      status = rwmf_run_case(scene, &again, message, sizeof message);
      if (status == 0 && again.u_s_max != result.u_s_max) return 3;
   }
   rwmf_destroy_case(&scene);
   if (status != 0) {
      fprintf(stderr, "%s\n", message);
      return 1;
   }
   printf("%.6f m\n", result.u_s_max);
   return result.u_s_max > 0.1 && result.u_s_max < 1.0 ? 0 : 2;
}
