/* Types of the Functional Mock-up Interface 3.0 (https://fmi-standard.org), as this library uses
 * them, and the mark of its functions. tests/python/export/test_fmu.py compares all signatures with
 * the headers of FMPy. */
#ifndef RWMF_FMI3_H
#define RWMF_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
   fmi3Independent,
   fmi3Constant,
   fmi3Fixed,
   fmi3Tunable,
   fmi3Discrete,
   fmi3Dependent
} fmi3DependencyKind;
typedef enum {
   fmi3IntervalNotYetKnown,
   fmi3IntervalUnchanged,
   fmi3IntervalChanged
} fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status,
                                       fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment environment);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment, double time,
                                               fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                               fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early,
                                               fmi3Boolean *early_return_requested,
                                               double *early_return_time);

#endif
