/* One instance of the model behind an FMU: its variables, and the wall or element that computes them.
 * fmu.c gives it the functions of the standard. */
#ifndef RWMF_FMI_MODEL_H
#define RWMF_FMI_MODEL_H

#include "rwmf.h"
#include <stdbool.h>

enum { MESSAGE_SIZE = 1024, KEY_SIZE = 64 };

/* Classes of variables, as variables.txt of the FMU writes them. */
enum {
   OF_CASE = 'p',  /* a number of the case: fixed parameter */
   SETTING = 's',  /* another fixed parameter */
   INPUT = 'i',
   OUTPUT = 'o',   /* of the table of quantities */
   RESPONSE = 'r'  /* an output that has its place in `responses` or `element_responses` */
};

typedef struct {
   char class;
   char type; /* 'f' Float64, 'i' Int64, 'b' Boolean */
   char key[KEY_SIZE];
   int count;      /* numbers of its key in the case; a list has a variable for each */
   double start;
   int32_t number; /* of an output for rwmf_query_outputs; place of a response */
   double value;
   bool is_set;    /* by the importer */
} variable;

typedef struct {
   bool of_link;  /* the motion of the link is given, not that of the ground */
   bool is_hinged; /* an element without impacts */
   bool stops;    /* a step ends at an impact */
   bool is_built; /* wall or element belong to the present parameters */
   bool is_known; /* the outputs belong to the present state */
   char token[KEY_SIZE];
   size_t n;      /* variables; the value reference of the first is 1, time is 0 */
   variable *variables;
   double t_begin, t; /* s */
   rwmf_case *scene;
   rwmf_wall *wall;
   rwmf_element *element;
   int side;      /* of the element: 1, -1, 0 at rest */
   int64_t impacts, lift_offs;
   char message[MESSAGE_SIZE]; /* of the last failure */
} model;

/* State of a model that can be restored. */
typedef struct {
   double t_begin, t;
   int side;
   int64_t impacts, lift_offs;
   bool is_built;
   rwmf_snapshot *snapshot; /* NULL without a wall */
   double *values;          /* of all variables */
   bool *are_set;
} saved_model;

/* Every function that can fail returns false, and has put what is wrong into `message`. */
bool fail(model *m, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Read case.nml and variables.txt of the folder, which ends with its separator. */
bool read_model(model *m, const char *folder);
void free_model(model *m);
/* Return to the start values. */
void reset_model(model *m);
/* Make wall or element with the present parameters. */
bool build(model *m);
/* Advance to a time, or with `stops` to the first impact (or other event) before it. */
bool advance_model(model *m, double t, bool *has_event);
/* Compute all outputs, unless they are known. */
bool compute_outputs(model *m);
bool save_model(model *m, saved_model **saved);
bool restore_model(model *m, const saved_model *saved);
void free_saved(saved_model **saved);

#endif
