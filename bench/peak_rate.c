/* The most that one core can do: multiplications and additions per second [1/s], each counted as
   one operation, without and with fused multiply-add, in as many lanes as the machine has.

   Twelve independent accumulators hide the latency; they stay in registers and stay finite.
   Prints lanes, rate without, rate with. */
#include <math.h>
#include <stdio.h>
#include <time.h>

#if defined __AVX512F__
#define LANES 8
#elif defined __AVX__
#define LANES 4
#else
#define LANES 2
#endif
#define ROUNDS 2000000

typedef double vector_t __attribute__((vector_size(8 * LANES)));

static double seconds(void) {
   struct timespec now;
   timespec_get(&now, TIME_UTC);
   return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A variable each: an array would live in memory. */
#define EACH(DO) DO(a) DO(b) DO(c) DO(d) DO(e) DO(f) DO(g) DO(h) DO(i) DO(j) DO(k) DO(l)
#define CHAINS 12
#define START(X) vector_t X = shift * (double)(0 + #X[0]);
#define TURN(X) X = X * scale + shift;
#define KEEP(X) __asm__ volatile("" : "+x"(X)); /* the compiler must not shorten the loop */
#define TOTAL(X) *sum += X[0];

/* Two functions of it: with and without contraction to fused multiply-add. */
#define RATE(NAME, CONTRACT)                                                     \
   static __attribute__((noinline, optimize("fp-contract=" CONTRACT)))           \
   double NAME(double factor, double term, double *sum) {                        \
      vector_t scale = {0}, shift = {0};                                         \
      scale += factor;                                                           \
      shift += term;                                                             \
      EACH(START)                                                                \
      const double begin = seconds();                                            \
      for (int round = 0; round < ROUNDS; round++) {                             \
         EACH(TURN)                                                              \
         EACH(KEEP)                                                              \
      }                                                                          \
      const double spent = seconds() - begin;                                    \
      EACH(TOTAL)                                                                \
      return 2.0 * LANES * CHAINS * ROUNDS / spent;                              \
   }

RATE(plain_rate, "off")
RATE(fused_rate, "fast")

int main(void) {
   double plain = 0, fused = 0, sum = 0;
   for (int r = 0; r < 60; r++) {
      plain = fmax(plain, plain_rate(0.999999, 1e-6, &sum));
      fused = fmax(fused, fused_rate(0.999999, 1e-6, &sum));
   }
   printf("%d %.4e %.4e\n", LANES, plain, fused);
   return sum > 0 ? 0 : 1;
}
