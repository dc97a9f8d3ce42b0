/* Where counting of instructions begins and ends, for programs that run under valgrind's callgrind
 * with --instr-atstart=no. Outside valgrind both functions do nothing.
 *
 * The sequence below is valgrind's client request for x86-64 and Linux (valgrind/valgrind.h):
 * valgrind knows it by its rotations, which leave the register as it was. It is repeated here so
 * that the build does not depend on valgrind. */

enum { ZERO_STATS = 0x43540001, DUMP_STATS_AT = 0x43540003, START = 0x43540004, STOP = 0x43540005 };

void rwmf_begin_count(void);
void rwmf_end_count(const char *name);

static void request(unsigned long code, const char *text)
{
   volatile unsigned long arguments[6] = {code, (unsigned long)text, 0, 0, 0, 0};
   unsigned long result = 0;

   __asm__ volatile("rolq $3, %%rdi; rolq $13, %%rdi; rolq $61, %%rdi; rolq $51, %%rdi\n\t"
                    "xchgq %%rbx, %%rbx"
                    : "+d"(result)
                    : "a"(&arguments[0])
                    : "cc", "memory");
}

/* Instructions count from here on. */
void rwmf_begin_count(void)
{
   request(START, 0);
   request(ZERO_STATS, 0);
}

/* Callgrind writes a file whose trigger is `name`; what follows does not count. */
void rwmf_end_count(const char *name)
{
   request(DUMP_STATS_AT, name);
   request(STOP, 0);
}
