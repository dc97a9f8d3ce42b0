/* An instance of the FMU, shared by the files that define functions of FMI 3.0. */
#ifndef RWMF_FMI_FMU_H
#define RWMF_FMI_FMU_H

#include "fmi3.h"
#include "model.h"

#define FMI3 __attribute__((visibility("default")))

enum { INSTANTIATED, INITIALIZATION, STEP, EVENT, INTERMEDIATE, TERMINATED };

typedef struct {
   char name[128];
   fmi3InstanceEnvironment environment;
   fmi3LogMessageCallback log;            /* may be NULL */
   fmi3IntermediateUpdateCallback update; /* may be NULL */
   bool has_event_mode, may_return_early;
   int mode;
   double t_end; /* s; infinite without one */
   model model;
} instance;

FMI3 void fmi3FreeInstance(fmi3Instance handle);

/* Send the reason of a refused call to the logger and return fmi3Error. */
fmi3Status refuse(instance *c, const char *function, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
