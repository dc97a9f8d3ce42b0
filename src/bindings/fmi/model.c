/* The model behind an FMU, on the functions of rwmf.h. */
#include "model.h"
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TALK m->message, sizeof m->message

bool fail(model *m, const char *format, ...) {
   va_list arguments;
   va_start(arguments, format);
   vsnprintf(m->message, sizeof m->message, format, arguments);
   va_end(arguments);
   return false;
}

/* --- variables --- */

/* Value of a variable by its key; every FMU has those that the code asks for. */
static variable *find(model *m, const char *key) {
   for (size_t i = 0; i < m->n; i++)
      if (strcmp(m->variables[i].key, key) == 0) return &m->variables[i];
   return NULL;
}

static double value_of(model *m, const char *key) {
   const variable *v = find(m, key);
   return v ? v->value : 0;
}

/* Outputs of a wall that its own structures hold, and those of an element. */
static const char *const responses[] = {"u_s_ddot_m_s2", "link_force", "frame_shear",
                                        "cable_tension", "at_rest"};
static const char *const element_responses[] = {
    "force",      "stiffness",     "damping",         "mass", "theta",   "theta_dot",
    "theta_ddot", "cable_tension", "velocity_factor", "side", "impacts", "lift_offs"};

static bool place_response(model *m, variable *v) {
   const char *const *keys = m->of_link ? element_responses : responses;
   const size_t n = m->of_link ? sizeof element_responses / sizeof *keys
                               : sizeof responses / sizeof *keys;
   for (size_t i = 0; i < n; i++)
      if (strcmp(v->key, keys[i]) == 0) {
         v->number = (int32_t)i;
         return true;
      }
   return fail(m, "variables.txt: %s: unknown output", v->key);
}

static bool read_variables(model *m, FILE *file) {
   char kind[16];
   if (fscanf(file, "%63s %15s %zu", m->token, kind, &m->n) != 3 || m->n > 100000)
      return fail(m, "variables.txt: its first line is no header");
   m->is_hinged = strcmp(kind, "hinge") == 0;
   m->of_link = m->is_hinged || strcmp(kind, "link") == 0;
   m->variables = calloc(m->n + 1, sizeof *m->variables);
   if (!m->variables) return fail(m, "out of memory");
   for (size_t i = 0; i < m->n; i++) {
      variable *v = &m->variables[i];
      if (fscanf(file, " %c %c %63s %d %lf", &v->class, &v->type, v->key, &v->count, &v->start) != 5 ||
          v->count < 1 || (size_t)v->count > m->n)
         return fail(m, "variables.txt: line %zu: no variable", i + 2);
      v->value = v->start;
      if (v->class == OUTPUT && rwmf_find_output(v->key, &v->number, TALK) != 0) return false;
      if (v->class == RESPONSE && !place_response(m, v)) return false;
   }
   return true;
}

bool read_model(model *m, const char *folder) {
   const size_t room = strlen(folder) + 16;
   char *path = malloc(room);
   bool is_read = false;
   if (!path) return fail(m, "out of memory");
   snprintf(path, room, "%svariables.txt", folder);
   FILE *file = fopen(path, "r");
   if (!file) {
      fail(m, "%s: %s", path, strerror(errno));
   } else {
      is_read = read_variables(m, file);
      fclose(file);
   }
   snprintf(path, room, "%scase.nml", folder);
   is_read = is_read && rwmf_read_case_file(path, &m->scene, TALK) == 0;
   free(path);
   return is_read;
}

static void destroy_parts(model *m) {
   rwmf_destroy(&m->wall);
   rwmf_destroy_element(&m->element);
   m->is_built = m->is_known = false;
}

void free_model(model *m) {
   destroy_parts(m);
   rwmf_destroy_case(&m->scene);
   free(m->variables);
   m->variables = NULL;
   m->n = 0;
}

void reset_model(model *m) {
   destroy_parts(m);
   for (size_t i = 0; i < m->n; i++) {
      m->variables[i].value = m->variables[i].start;
      m->variables[i].is_set = false;
   }
}

/* --- wall or element --- */

/* The case with the numbers that the importer has set. A list with a set number is given whole. */
static bool change_numbers(model *m, rwmf_case **changed) {
   const char **keys = malloc((m->n + 1) * sizeof *keys);
   size_t *sizes = malloc((m->n + 1) * sizeof *sizes);
   double *values = malloc((m->n + 1) * sizeof *values);
   size_t n = 0, total = 0;
   bool is_done = keys && sizes && values;
   if (!is_done) fail(m, "out of memory");
   for (size_t i = 0; is_done && i < m->n; i += (size_t)m->variables[i].count) {
      bool is_set = false;
      const variable *v = &m->variables[i];
      if (v->class != OF_CASE) continue;
      for (int k = 0; k < v->count; k++) is_set = is_set || v[k].is_set;
      if (!is_set) continue;
      keys[n] = v->key;
      sizes[n++] = (size_t)v->count;
      for (int k = 0; k < v->count; k++) values[total++] = v[k].value;
   }
   if (is_done && n > 0)
      is_done = rwmf_change_case(m->scene, n, keys, sizes, values, changed, TALK) == 0;
   free(keys);
   free(sizes);
   free(values);
   return is_done;
}

/* Side on which the element starts: the given one, else that of the displacement. */
static int first_side(model *m) {
   const double side = value_of(m, "start_side"), u = value_of(m, "u");
   if (m->is_hinged) return 1;
   if (side > 0 || side < 0) return side > 0 ? 1 : -1;
   return (u > 0) - (u < 0);
}

bool build(model *m) {
   rwmf_case *changed = NULL;
   bool is_made = false;
   if (m->is_built) return true;
   destroy_parts(m);
   m->t = m->t_begin;
   m->impacts = m->lift_offs = 0;
   if (!change_numbers(m, &changed)) return false;
   const rwmf_case *scene = changed ? changed : m->scene;
   if (m->of_link) {
      const double side = value_of(m, "start_side");
      if (side > 1 || side < -1)
         fail(m, "start_side = %g: must be 1, -1, or 0 for the side of u", side);
      else
         is_made = rwmf_create_element_from_case(scene, &m->element, TALK) == 0;
      m->side = first_side(m);
   } else {
      is_made = rwmf_create_from_case(scene, m->t_begin, value_of(m, "peak_ground_acceleration"),
                                      &m->wall, TALK) == 0 &&
                rwmf_stop_at_impacts(m->wall, m->stops, TALK) == 0;
   }
   rwmf_destroy_case(&changed);
   m->is_built = is_made;
   return is_made;
}

/* One advance of the wall: under its own motion, or under a straight line. */
static bool advance_wall(model *m, double t, bool *has_event) {
   const bool is_own = value_of(m, "own_motion") != 0;
   const double a = value_of(m, "ground_acceleration");
   rwmf_state before, after;
   rwmf_ending ending;
   if (is_own && a != 0)
      return fail(m, "ground_acceleration = %g m/s2 has no effect: the wall follows the motion of its "
                     "case; set own_motion to false before the initialisation ends", a);
   if (rwmf_query_state(m->wall, &before, TALK) != 0) return false;
   if (is_own) {
      if (rwmf_advance(m->wall, t, TALK) != 0) return false;
   } else {
      const double times[2] = {m->t, t};
      const double a_end = value_of(m, "ground_acceleration_end");
      const double samples[2] = {a, value_of(m, "ground_is_linear") != 0 ? a_end : a};
      if (rwmf_advance_samples(m->wall, 2, times, samples, TALK) != 0) return false;
   }
   if (rwmf_query_state(m->wall, &after, TALK) != 0) return false;
   if (rwmf_query_ending(m->wall, &ending, TALK) != 0) return false;
   *has_event = after.impacts > before.impacts;
   m->t = t;
   /* an impact within round-off of the end is at the end */
   if (m->stops && *has_event && !ending.overturned && !ending.collapsed &&
       after.t < t - 1e-14 * fabs(t))
      m->t = after.t;
   return true;
}

/* Apply the first event of the element in a step of length h: 1 and its time, or 0 without one. The
 * motion of the link continues with its acceleration. */
static int apply_link_event(model *m, double h, double *tau) {
   const double u = value_of(m, "u"), v = value_of(m, "u_dot"), a = value_of(m, "u_ddot");
   const double push = value_of(m, "push"), ground = value_of(m, "ground_acceleration");
   if (m->side == 0) {
      const int side = rwmf_next_lift_off(m->element, h, push, push, ground, ground, tau);
      if (side != 1 && side != -1) return side;
      m->side = side;
      m->lift_offs++;
      return 1;
   }
   const double factor = rwmf_velocity_factor(m->element);
   const int found = rwmf_next_impact(m->side, h, u, v, u + h * (v + h * a / 2), v + h * a, tau);
   if (found != 1) return found;
   m->impacts++;
   m->side = -m->side;
   const int stays = rwmf_settles(m->element, h, factor * (v + *tau * a), push, ground,
                                  value_of(m, "host_mass"));
   if (stays == 1) m->side = 0;
   return stays == 0 || stays == 1 ? 1 : stays;
}

static bool advance_link(model *m, double t, bool *has_event) {
   double tau = 0;
   const double h = t - m->t;
   int found = 0;
   if (!m->is_hinged) found = apply_link_event(m, h, &tau);
   if (found != 0 && found != 1) return fail(m, "the motion of the link is out of range");
   *has_event = found == 1;
   m->t = m->stops && *has_event ? m->t + tau : t;
   return true;
}

bool advance_model(model *m, double t, bool *has_event) {
   m->is_known = false;
   return m->of_link ? advance_link(m, t, has_event) : advance_wall(m, t, has_event);
}

/* --- outputs --- */

static bool compute_wall(model *m) {
   rwmf_state state;
   rwmf_forces forces;
   size_t n = 0;
   bool is_done = false;
   int32_t *numbers = malloc((m->n + 1) * sizeof *numbers);
   double *values = malloc((m->n + 1) * sizeof *values);
   if (!numbers || !values) {
      fail(m, "out of memory");
   } else {
      for (size_t i = 0; i < m->n; i++)
         if (m->variables[i].class == OUTPUT) numbers[n++] = m->variables[i].number;
      is_done = rwmf_query_state(m->wall, &state, TALK) == 0 &&
                rwmf_query_forces(m->wall, &forces, TALK) == 0 &&
                (n == 0 || rwmf_query_outputs(m->wall, n, numbers, values, TALK) == 0);
   }
   if (is_done) {
      const double found[] = {state.u_s_ddot, forces.link, forces.frame_shear, forces.cable,
                              state.at_rest};
      n = 0;
      for (size_t i = 0; i < m->n; i++) {
         if (m->variables[i].class == OUTPUT) m->variables[i].value = values[n++];
         if (m->variables[i].class == RESPONSE) m->variables[i].value = found[m->variables[i].number];
      }
   }
   free(numbers);
   free(values);
   return is_done;
}

static bool compute_link(model *m) {
   rwmf_response r = {0};
   const int side = m->side;
   /* at rest the link transmits the push of the host */
   if (side == 0)
      r.force = value_of(m, "push");
   else if (rwmf_respond(m->element, side, value_of(m, "u"), value_of(m, "u_dot"),
                         value_of(m, "u_ddot"), value_of(m, "ground_acceleration"), &r, TALK) != 0)
      return false;
   const double found[] = {
       r.force,      r.stiffness, r.damping, r.mass, r.theta, r.theta_dot,
       r.theta_ddot, r.cable,     rwmf_velocity_factor(m->element),
       side,         (double)m->impacts, (double)m->lift_offs};
   for (size_t i = 0; i < m->n; i++)
      if (m->variables[i].class == RESPONSE) m->variables[i].value = found[m->variables[i].number];
   return true;
}

bool compute_outputs(model *m) {
   if (m->is_known) return true;
   m->is_known = m->of_link ? compute_link(m) : compute_wall(m);
   return m->is_known;
}

/* --- states --- */

bool save_model(model *m, saved_model **saved) {
   saved_model *s = *saved;
   if (!s) s = calloc(1, sizeof *s);
   if (s && !s->values) s->values = malloc((m->n + 1) * sizeof *s->values);
   if (s && !s->are_set) s->are_set = malloc((m->n + 1) * sizeof *s->are_set);
   if (!s || !s->values || !s->are_set) {
      if (!*saved) free_saved(&s);
      return fail(m, "out of memory");
   }
   if (m->wall && rwmf_save(m->wall, &s->snapshot, TALK) != 0) {
      if (!*saved) free_saved(&s);
      return false;
   }
   s->t_begin = m->t_begin;
   s->t = m->t;
   s->side = m->side;
   s->impacts = m->impacts;
   s->lift_offs = m->lift_offs;
   s->is_built = m->is_built;
   for (size_t i = 0; i < m->n; i++) {
      s->values[i] = m->variables[i].value;
      s->are_set[i] = m->variables[i].is_set;
   }
   *saved = s;
   return true;
}

bool restore_model(model *m, const saved_model *s) {
   for (size_t i = 0; i < m->n; i++) {
      variable *v = &m->variables[i];
      const bool is_fixed = v->class == OF_CASE || v->class == SETTING;
      if (is_fixed && (v->value < s->values[i] || v->value > s->values[i])) m->is_built = false;
      v->value = s->values[i];
      v->is_set = s->are_set[i];
   }
   m->t_begin = s->t_begin;
   if (s->is_built) {
      if (!build(m)) return false;
      if (m->wall && rwmf_restore(m->wall, s->snapshot, TALK) != 0) return false;
   } else {
      destroy_parts(m);
   }
   m->t = s->t;
   m->side = s->side;
   m->impacts = s->impacts;
   m->lift_offs = s->lift_offs;
   m->is_known = false;
   return true;
}

void free_saved(saved_model **saved) {
   if (!*saved) return;
   rwmf_destroy_snapshot(&(*saved)->snapshot);
   free((*saved)->values);
   free((*saved)->are_set);
   free(*saved);
   *saved = NULL;
}
