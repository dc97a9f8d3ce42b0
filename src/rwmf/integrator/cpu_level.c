/* Which compilation of the vectorised loops can this processor run? See lane_kernels.F90. */

int rwmf_processor_level(void);

int rwmf_processor_level(void)
{
   __builtin_cpu_init();
   if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
       __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
       __builtin_cpu_supports("avx512cd")) {
      return 4;
   }
   return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")
             ? 3
             : 1;
}
