/* Functions of FMI 3.0 for co-simulation. Each checks that the mode of the instance allows the call;
 * a refused call returns fmi3Error, sends its reason to the logger of the importer and changes nothing.
 * unsupported.c has the functions that the model description declares as absent. */
#include "fmu.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const mode_names[] = {"instantiated", "initialization mode", "step mode",
                                         "event mode", "intermediate update", "terminated"};

fmi3Status refuse(instance *c, const char *function, const char *format, ...) {
   char text[MESSAGE_SIZE + 256];
   va_list arguments;
   int n = snprintf(text, sizeof text, "%s: %s: ", c->name, function);
   if (n < 0 || (size_t)n >= sizeof text) n = 0;
   va_start(arguments, format);
   vsnprintf(text + n, sizeof text - (size_t)n, format, arguments);
   va_end(arguments);
   if (c->log) c->log(c->environment, fmi3Error, "logStatusError", text);
   return fmi3Error;
}

/* Whether a function is called in one of its modes, a bit each. */
static bool is_in(instance *c, const char *function, unsigned modes) {
   if (modes >> c->mode & 1) return true;
   refuse(c, function, "not allowed here (%s)", mode_names[c->mode]);
   return false;
}

#define IN(mode) (1u << (mode))
#define ALL_MODES (IN(INTERMEDIATE) - 1 + IN(TERMINATED))

/* --- creation --- */

FMI3 const char *fmi3GetVersion(void) { return "3.0"; }

FMI3 fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean has_event_mode, fmi3Boolean may_return_early, const fmi3ValueReference required[],
    size_t n_required, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
   (void)visible, (void)logging, (void)required, (void)n_required;
   instance *c = calloc(1, sizeof *c);
   if (!c) return NULL;
   snprintf(c->name, sizeof c->name, "%s", name ? name : "rwmf");
   c->environment = environment;
   c->log = log;
   c->update = update;
   c->has_event_mode = has_event_mode;
   c->may_return_early = may_return_early;
   c->model.stops = may_return_early || update;
   if (!resources)
      refuse(c, __func__, "no path of the resources");
   else if (!read_model(&c->model, resources))
      refuse(c, __func__, "%s", c->model.message);
   else if (!token || strcmp(token, c->model.token) != 0)
      refuse(c, __func__, "the instantiation token is not that of this FMU, %s", c->model.token);
   else
      return c;
   fmi3FreeInstance(c);
   return NULL;
}

FMI3 void fmi3FreeInstance(fmi3Instance handle) {
   instance *c = handle;
   if (!c) return;
   free_model(&c->model);
   free(c);
}

FMI3 fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean logging, size_t n,
                                    const fmi3String categories[]) {
   (void)logging;
   for (size_t i = 0; i < n; i++)
      if (!categories || !categories[i] || strcmp(categories[i], "logStatusError") != 0)
         return refuse(handle, __func__, "the only category is logStatusError");
   return fmi3OK;
}

/* --- modes --- */

FMI3 fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean has_tolerance,
                                            double tolerance, double t_begin, fmi3Boolean has_end,
                                            double t_end) {
   instance *c = handle;
   /* the tolerance is a number of the case, solver.rtol */
   (void)has_tolerance, (void)tolerance;
   if (!is_in(c, __func__, IN(INSTANTIATED))) return fmi3Error;
   if (!isfinite(t_begin)) return refuse(c, __func__, "the start time is no number");
   if (has_end && !(t_end >= t_begin))
      return refuse(c, __func__, "the stop time %g s is before the start time %g s", t_end, t_begin);
   c->model.t_begin = c->model.t = t_begin;
   c->model.is_built = false;
   c->t_end = has_end ? t_end : INFINITY;
   c->mode = INITIALIZATION;
   return fmi3OK;
}

FMI3 fmi3Status fmi3ExitInitializationMode(fmi3Instance handle) {
   instance *c = handle;
   if (!is_in(c, __func__, IN(INITIALIZATION))) return fmi3Error;
   if (!build(&c->model)) return refuse(c, __func__, "%s", c->model.message);
   c->mode = c->has_event_mode ? EVENT : STEP;
   return fmi3OK;
}

FMI3 fmi3Status fmi3EnterEventMode(fmi3Instance handle) {
   instance *c = handle;
   if (!is_in(c, __func__, IN(STEP))) return fmi3Error;
   if (!c->has_event_mode) return refuse(c, __func__, "instantiated without event mode");
   c->mode = EVENT;
   return fmi3OK;
}

FMI3 fmi3Status fmi3EnterStepMode(fmi3Instance handle) {
   instance *c = handle;
   if (!is_in(c, __func__, IN(EVENT))) return fmi3Error;
   c->mode = STEP;
   return fmi3OK;
}

/* An impact has already been applied when its step returns: nothing is left to update. */
FMI3 fmi3Status fmi3UpdateDiscreteStates(fmi3Instance handle, fmi3Boolean *needs_update,
                                         fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                         fmi3Boolean *values_changed, fmi3Boolean *has_next,
                                         double *next_time) {
   if (!is_in(handle, __func__, IN(EVENT))) return fmi3Error;
   if (needs_update) *needs_update = false;
   if (terminate) *terminate = false;
   if (nominals_changed) *nominals_changed = false;
   if (values_changed) *values_changed = false;
   if (has_next) *has_next = false;
   if (next_time) *next_time = 0;
   return fmi3OK;
}

FMI3 fmi3Status fmi3Terminate(fmi3Instance handle) {
   instance *c = handle;
   if (!is_in(c, __func__, IN(STEP) | IN(EVENT))) return fmi3Error;
   c->mode = TERMINATED;
   return fmi3OK;
}

FMI3 fmi3Status fmi3Reset(fmi3Instance handle) {
   instance *c = handle;
   if (!is_in(c, __func__, ALL_MODES)) return fmi3Error;
   reset_model(&c->model);
   c->mode = INSTANTIATED;
   return fmi3OK;
}

/* --- variables --- */

enum { TIME = 0 };

/* A variable of a type; NULL, with a message, when there is none. */
static variable *find(instance *c, const char *function, fmi3ValueReference reference, char type) {
   if (reference < 1 || reference > c->model.n) {
      refuse(c, function, "%u is no value reference of this type", (unsigned)reference);
      return NULL;
   }
   variable *v = &c->model.variables[reference - 1];
   if (v->type == type) return v;
   refuse(c, function, "%s is of another type", v->key);
   return NULL;
}

static bool has_room(instance *c, const char *function, size_t n, size_t n_values) {
   if (n == n_values) return true;
   refuse(c, function, "%zu values for %zu variables", n_values, n);
   return false;
}

/* Value of a variable; outputs exist from the initialization on. */
static bool get(instance *c, const char *function, fmi3ValueReference reference, char type,
                double *value) {
   if (reference == TIME && type == 'f') {
      *value = c->model.t;
      return true;
   }
   variable *v = find(c, function, reference, type);
   if (!v) return false;
   if (v->class == OUTPUT || v->class == RESPONSE) {
      if (!is_in(c, function, ~IN(INSTANTIATED))) return false;
      if (!build(&c->model) || !compute_outputs(&c->model)) {
         refuse(c, function, "%s: %s", v->key, c->model.message);
         return false;
      }
   }
   *value = v->value;
   return true;
}

/* Whether a variable takes a value now. */
static bool may_set(instance *c, const char *function, fmi3ValueReference reference, char type,
                    double value) {
   const variable *v = find(c, function, reference, type);
   if (!v) return false;
   if (v->class == OUTPUT || v->class == RESPONSE) {
      refuse(c, function, "%s is an output", v->key);
   } else if (!isfinite(value)) {
      refuse(c, function, "%s = %g: must be a finite number", v->key, value);
   } else if (v->class != INPUT && !((IN(INSTANTIATED) | IN(INITIALIZATION)) >> c->mode & 1)) {
      refuse(c, function, "%s is fixed: must be set before the initialization ends", v->key);
   } else {
      return is_in(c, function, IN(INSTANTIATED) | IN(INITIALIZATION) | IN(STEP) | IN(EVENT));
   }
   return false;
}

static void set(instance *c, fmi3ValueReference reference, double value) {
   variable *v = &c->model.variables[reference - 1];
   v->value = value;
   v->is_set = true;
   c->model.is_known = false;
   /* the side on which an element starts follows from its first displacement */
   if (v->class != INPUT || c->mode < STEP) c->model.is_built = false;
}

/* Getter and setter of a type: all values are checked before the first one is set. */
#define ACCESS(NAME, TYPE, LETTER)                                                                  \
   FMI3 fmi3Status fmi3Get##NAME(fmi3Instance handle, const fmi3ValueReference references[],         \
                                 size_t n, TYPE values[], size_t n_values) {                        \
      double value = 0;                                                                             \
      if (!has_room(handle, __func__, n, n_values)) return fmi3Error;                               \
      for (size_t i = 0; i < n; i++) {                                                              \
         if (!get(handle, __func__, references[i], LETTER, &value)) return fmi3Error;               \
         values[i] = LETTER != 'f' && isnan(value) ? (TYPE)0 : (TYPE)value;                         \
      }                                                                                             \
      return fmi3OK;                                                                                \
   }                                                                                                \
   FMI3 fmi3Status fmi3Set##NAME(fmi3Instance handle, const fmi3ValueReference references[],         \
                                 size_t n, const TYPE values[], size_t n_values) {                  \
      if (!has_room(handle, __func__, n, n_values)) return fmi3Error;                               \
      for (size_t i = 0; i < n; i++)                                                                \
         if (!may_set(handle, __func__, references[i], LETTER, (double)values[i])) return fmi3Error; \
      for (size_t i = 0; i < n; i++) set(handle, references[i], (double)values[i]);                 \
      return fmi3OK;                                                                                \
   }

ACCESS(Float64, double, 'f')
ACCESS(Int64, int64_t, 'i')
ACCESS(Boolean, fmi3Boolean, 'b')

/* --- steps --- */

/* Tell the importer of an impact, and return whether the step ends there. Without the callback every
 * impact ends a step that may end early. */
static bool ends_here(instance *c, double *t_target) {
   fmi3Boolean is_requested = false;
   double t_requested = c->model.t;
   if (c->has_event_mode && c->may_return_early) return true;
   if (!c->update) return c->may_return_early;
   c->mode = INTERMEDIATE;
   c->update(c->environment, c->model.t, false, true, true, c->may_return_early, &is_requested,
             &t_requested);
   c->mode = STEP;
   if (!is_requested || !c->may_return_early) return false;
   if (t_requested > c->model.t) *t_target = fmin(*t_target, t_requested);
   return !(t_requested > c->model.t);
}

static fmi3Status advance(instance *c, double t, fmi3Boolean *event_needed,
                          fmi3Boolean *early_return) {
   bool has_event = false, is_over = false;
   double t_target = t;
   while (!is_over) {
      if (!advance_model(&c->model, t_target, &has_event))
         return refuse(c, "fmi3DoStep", "%s", c->model.message);
      is_over = !(c->model.t < t_target);
      if (has_event && c->may_return_early && c->has_event_mode) *event_needed = true;
      if (has_event && !is_over) is_over = ends_here(c, &t_target);
   }
   *early_return = c->model.t < t;
   return fmi3OK;
}

FMI3 fmi3Status fmi3DoStep(fmi3Instance handle, double t, double h,
                           fmi3Boolean no_set_state_before, fmi3Boolean *event_needed,
                           fmi3Boolean *terminate, fmi3Boolean *early_return,
                           double *last_successful) {
   instance *c = handle;
   (void)no_set_state_before;
   if (!is_in(c, __func__, IN(STEP))) return fmi3Error;
   if (!event_needed || !terminate || !early_return || !last_successful)
      return refuse(c, __func__, "the address of an answer is NULL");
   *event_needed = *terminate = *early_return = false;
   *last_successful = c->model.t;
   const double slack = 1e-9 * fmax(1, fabs(c->model.t));
   if (!(fabs(t - c->model.t) <= slack))
      return refuse(c, __func__, "the step begins at %.17g s, but the time is %.17g s", t, c->model.t);
   if (!(h > 0) || !isfinite(h))
      return refuse(c, __func__, "a step of %g s: must be positive", h);
   if (t + h > c->t_end + slack)
      return refuse(c, __func__, "the step ends at %.17g s, after the stop time %.17g s", t + h,
                    c->t_end);
   const fmi3Status status = advance(c, t + h, event_needed, early_return);
   *last_successful = c->model.t;
   return status;
}

/* --- states --- */

/* A state with the mode that it belongs to. */
typedef struct {
   saved_model *saved;
   int mode;
   double t_end;
} fmu_state;

FMI3 fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state) {
   instance *c = handle;
   if (!is_in(c, __func__, ALL_MODES)) return fmi3Error;
   if (!state) return refuse(c, __func__, "the address of the state is NULL");
   fmu_state *s = *state ? *state : calloc(1, sizeof *s);
   if (!s) return refuse(c, __func__, "out of memory");
   if (!save_model(&c->model, &s->saved)) {
      if (!*state) free(s);
      return refuse(c, __func__, "%s", c->model.message);
   }
   s->mode = c->mode;
   s->t_end = c->t_end;
   *state = s;
   return fmi3OK;
}

FMI3 fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state) {
   instance *c = handle;
   const fmu_state *s = state;
   if (!is_in(c, __func__, ALL_MODES)) return fmi3Error;
   if (!s) return refuse(c, __func__, "the state is NULL");
   if (!restore_model(&c->model, s->saved)) return refuse(c, __func__, "%s", c->model.message);
   c->mode = s->mode;
   c->t_end = s->t_end;
   return fmi3OK;
}

FMI3 fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state) {
   (void)handle;
   if (!state || !*state) return fmi3OK;
   fmu_state *s = *state;
   free_saved(&s->saved);
   free(s);
   *state = NULL;
   return fmi3OK;
}
