/* Rocking walls in a host program written in C: walls that step with the host, and the wall as an
 * element of a host that owns the frame. See docs/howto/embedding.md.
 *
 * Every function that can fail returns 0, or one of the RWMF_ numbers; then `message` (room for
 * `size` bytes, may be NULL) says what went wrong, and everything is as it was before the call.
 * After a success the message is empty.
 * RWMF_INPUT answers every NULL where an address is needed, and every real that is not finite, above
 * 1e30 in size (times: 1e10 s), or negative where that has no meaning.
 * Nothing prints, nothing is kept between calls, any thread may call with its own handles. */
#ifndef RWMF_H
#define RWMF_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { RWMF_NUMERICAL = 1, RWMF_INPUT = 2, RWMF_INTERRUPTED = 130 };

/* What became of a row. */
enum {
   RWMF_ROW_OK = 0,
   RWMF_ROW_OVERTURNED = 1,
   RWMF_ROW_COLLAPSED = 2,  /* a drift passed the limit of an effect */
   RWMF_ROW_INACCURATE = 3, /* errs by more than `accuracy`; the results are the best that there are */
   RWMF_ROW_REFUSED = 4,    /* the rules of the case do not allow its numbers; the results are NaN */
   RWMF_ROW_FAILED = 5      /* the integration did; the results are NaN */
};

enum {
   RWMF_EVENT_IMPACT = 1,
   RWMF_EVENT_PEAK = 2,
   RWMF_EVENT_LIFT_OFF = 3,
   RWMF_EVENT_REST = 4,
   RWMF_EVENT_OVERTURNED = 5,
   RWMF_EVENT_BRANCH = 6, /* of a member: a spring begins another branch */
   RWMF_EVENT_COLLAPSED = 9
};

typedef struct rwmf_case rwmf_case;         /* a case that has been read */
typedef struct rwmf_wall rwmf_wall;         /* a wall that steps */
typedef struct rwmf_snapshot rwmf_snapshot; /* a saved state */
typedef struct rwmf_element rwmf_element;   /* a wall without frame */
typedef struct rwmf_member rwmf_member;     /* a wall without frame that has memory */

/* Maxima of one simulation; what does not apply is NaN. */
typedef struct {
   double u_s_max;             /* m */
   double theta_max;           /* of |theta|, rad */
   double theta_dot_max;       /* rad/s */
   double cable_increment_max; /* P/(m_w g) - eta_0 */
   double t_end;               /* s */
   int64_t impacts;
   int64_t lift_offs;
   int64_t steps;
   int32_t overturned; /* 1 or 0 */
} rwmf_result;

typedef struct {
   double t;          /* s */
   double theta;      /* rad */
   double theta_dot;  /* rad/s */
   double theta_ddot; /* rad/s2 */
   double u_s;        /* m */
   double u_s_dot;    /* m/s */
   double u_s_ddot;   /* m/s2 */
   double u_s_max;    /* largest |u_s| so far, m */
   double theta_max;  /* largest |theta| so far, rad */
   int64_t impacts;
   int64_t lift_offs;
   int64_t steps;
   int32_t at_rest;
   int32_t overturned;
} rwmf_state;

/* How a motion has ended. Neither is 1 while it goes on. */
typedef struct {
   double t; /* when it did, or the present, s */
   int32_t overturned;
   int32_t collapsed; /* a drift passed the limit of an effect */
} rwmf_ending;

/* In N; in N per kg of the wall when the case has no m_w. */
typedef struct {
   double link;        /* from the wall on the frame */
   double frame_shear; /* of the frame's spring and damper */
   double cable;       /* tension */
} rwmf_forces;

typedef struct {
   double t;         /* s */
   double theta;     /* rad */
   double theta_dot; /* rad/s, before an impact */
   int32_t kind;     /* RWMF_EVENT_ */
} rwmf_event;

typedef struct {
   double force;      /* resisting force on the link, N */
   double stiffness;  /* N/m */
   double damping;    /* N s/m */
   double mass;       /* kg */
   double theta;      /* rad */
   double theta_dot;  /* rad/s */
   double theta_ddot; /* rad/s2 */
   double cable;      /* tension, N */
} rwmf_response;

/* Version of the library as text. */
void rwmf_version(char *text, size_t size);

/* One simulation of a case in namelist text. */
int rwmf_run(const char *namelist, rwmf_result *result, char *message, size_t size);

/* --- a case that is read once --- */

/* Read and check a case, its records included. Relative paths in the text start from `folder` (NULL:
 * the working folder). `*scene` has to be NULL. A case never changes: any number of threads may use
 * it at once. What is made from it does not need it any more. */
int rwmf_read_case(const char *namelist, const char *folder, rwmf_case **scene, char *message,
                   size_t size);

/* Samples of a ground acceleration, in the unit that the case says; straight lines between them. */
typedef struct {
   size_t n;                    /* at least 2 */
   const double *times;         /* n of them, increasing strictly, s; NULL: `dt` of the case */
   const double *accelerations; /* n of them */
} rwmf_samples;

/* The same with samples in place of the records of &motion and &vertical (NULL: a file, or none).
 * The key `file` of the group is then the name by which outputs call them; `unit`, `dt` and `scale`
 * hold as for a file. The samples are copied. */
int rwmf_read_case_with(const char *namelist, const char *folder, const rwmf_samples *motion,
                        const rwmf_samples *vertical, rwmf_case **scene, char *message,
                        size_t size);
/* The same from a file; relative paths start from its folder. What it cannot do is said of the file. */
int rwmf_read_case_file(const char *path, rwmf_case **scene, char *message, size_t size);
/* Sets *scene to NULL. Safe to call twice. */
void rwmf_destroy_case(rwmf_case **scene);
/* As `rwmf_run`, and as `rwmf_create` and `rwmf_create_element` below. */
int rwmf_run_case(const rwmf_case *scene, rwmf_result *result, char *message, size_t size);
/* As `rwmf_run_case`, and how the simulation ended. */
int rwmf_run_case_ending(const rwmf_case *scene, rwmf_result *result, rwmf_ending *ending,
                         char *message, size_t size);
int rwmf_create_from_case(const rwmf_case *scene, double t_begin, double peak, rwmf_wall **wall,
                          char *message, size_t size);
int rwmf_create_element_from_case(const rwmf_case *scene, rwmf_element **element, char *message,
                                  size_t size);

/* Rows of a table: runs of one case, each with its own numbers. */
typedef struct {
   size_t n_columns;           /* at least 1 */
   const char *const *columns; /* n_columns names: "T_s" (s), "gamma", "b" (m), "scale" (factor on the
                                  horizontal motion), or "group.key" of any key that holds a number */
   size_t n;                   /* rows, at least 1 */
   const double *values;       /* n*n_columns, row after row: that of row i and column j is
                                  values[i*n_columns + j], in the unit of its key */
   size_t n_quantities;        /* at least 1 */
   const char *const *quantities; /* n_quantities keys of numbers that `rwmf run` reports, "u_s_max_m" */
} rwmf_rows;

/* Run all rows in `threads` threads (0: all that OpenMP offers). `results` has room for
 * rows->n*n_quantities numbers, row after row: quantity k of row i is results[i*n_quantities + k], NaN
 * where it does not apply; counts, yes (1) and no (0) are numbers, too. `status` has room for rows->n
 * of RWMF_ROW_. A row that cannot be run is no failure of the call: the others go on. No bit of a row
 * depends on the other rows or on `threads`; it has those of `rwmf_run_case` by every method but 'auto',
 * which takes the pair for its tolerance here. */
int rwmf_run_rows(const rwmf_case *scene, const rwmf_rows *rows, int threads, double *results,
                  int32_t *status, char *message, size_t size);

/* --- a wall that steps --- */

/* `peak`: size of the ground acceleration to come, m/s2, sets the absolute tolerance unless the case
 * gives atol; <= 0: the case's motion or g/10. `*wall` has to be NULL. */
int rwmf_create(const char *namelist, double t_begin, double peak, rwmf_wall **wall,
                char *message, size_t size);
/* Sets *wall to NULL. Safe to call twice. */
void rwmf_destroy(rwmf_wall **wall);

/* Advance to t under the motion of the case. */
int rwmf_advance(rwmf_wall *wall, double t, char *message, size_t size);
/* Advance to t[n - 1] under straight lines through n >= 2 samples in m/s2; t[0] is the present. */
int rwmf_advance_samples(rwmf_wall *wall, size_t n, const double *t, const double *a,
                         char *message, size_t size);
/* Advance to t under an acceleration that is computed, smooth between now and t. `ground` must depend
 * on its arguments only. */
int rwmf_advance_ground(rwmf_wall *wall, double t, double (*ground)(double t, void *data),
                        void *data, char *message, size_t size);

int rwmf_query_state(const rwmf_wall *wall, rwmf_state *state, char *message, size_t size);
/* A wall that has overturned or collapsed stays as it is, whatever it is advanced to. */
int rwmf_query_ending(const rwmf_wall *wall, rwmf_ending *ending, char *message, size_t size);
int rwmf_query_forces(const rwmf_wall *wall, rwmf_forces *forces, char *message, size_t size);
/* Events of the last advance: the first `capacity` of `*count`. */
int rwmf_query_events(const rwmf_wall *wall, size_t capacity, rwmf_event *events, size_t *count,
                      char *message, size_t size);

/* `*snapshot` is made when it is NULL, else written over. */
int rwmf_save(rwmf_wall *wall, rwmf_snapshot **snapshot, char *message, size_t size);
int rwmf_restore(rwmf_wall *wall, const rwmf_snapshot *snapshot, char *message, size_t size);
void rwmf_destroy_snapshot(rwmf_snapshot **snapshot);

/* --- the wall as an element --- */

/* Of `&frame` it needs the mass ratio, for `&impact rule = 'coupled'` alone; T_s and xi_s have no
 * effect and may be absent in text, as the end of the simulation. */
int rwmf_create_element(const char *namelist, rwmf_element **element, char *message, size_t size);
void rwmf_destroy_element(rwmf_element **element);
/* `side`: 1 or -1, the side on which the wall rocks; of a hinged wall without effect. */
int rwmf_respond(const rwmf_element *element, int side, double u, double u_dot, double u_ddot,
                 double u_g_ddot, rwmf_response *response, char *message, size_t size);
/* Factor on the velocity of the link at an impact; NaN without an element. */
double rwmf_velocity_factor(const rwmf_element *element);
/* These look at a step of length dt >= 0. They have no message: RWMF_INPUT takes the place of the
 * answer, so ask for an answer by its number. */
/* First impact: 1 and its time since the beginning in *tau, or 0. */
int rwmf_next_impact(int side, double dt, double u_0, double u_dot_0, double u_1, double u_dot_1,
                     double *tau);
/* First lift-off of a resting wall in a step over which the host's push on it and the ground
 * acceleration vary linearly: the side (1 or -1) and its time in *tau, or 0. */
int rwmf_next_lift_off(const rwmf_element *element, double dt, double push_0, double push_1,
                       double u_g_ddot_0, double u_g_ddot_1, double *tau);
/* 1 when the wall may be put to rest after an impact, see howto/embedding.md, or 0; a hinged wall never
 * rests. */
int rwmf_settles(const rwmf_element *element, double dt, double u_dot, double push,
                 double u_g_ddot, double host_mass);

/* --- the wall as a member: an element with memory --- */

/* A member carries what an element refuses: fuses, tendons that yield or break, walls that bend, links
 * at every floor. Groups of the frame describe the frame of the host and have no effect, but for the
 * links of `&storeys` and the mass ratio for `rule = 'coupled'`; T_s and xi_s may be absent in text.
 *
 * Its n degrees of freedom, in this order:
 *    u          displacement of the straight wall at the link, as of an element, m
 *    q_1, ...   one for each mode of &bending, m
 *    u_1, ...   one for each floor on link springs (&storeys coupling = 'springs'), m
 * The host adds force and tangents to its equations. It owns every mass and spring of its frame; q_i
 * have only what the member adds. A motion is 3*n numbers: displacements, velocities, accelerations.
 * `ground` is u_g'' and v_g'' in m/s2; v_g'' is 0 unless the case has a vertical record (a ratio
 * follows u_g''). Forces are in N, per kg of the wall when the case has no m_w.
 *
 * The state is the side on which the wall rocks (1 or -1; 0: at rest, the initial state), u and the
 * branches of its springs. A response sets the trial state only, always from the committed one: its
 * path from there is straight in u. At a branch end the tangents are those of the branch that this
 * path enters; without a path those of the direction of u'. */
typedef struct {
   int32_t dofs;   /* n */
   int32_t modes;  /* of &bending */
   int32_t floors; /* on link springs */
   int32_t links;  /* between wall and host: 1, or one for each floor */
   int32_t side;   /* committed: 1 or -1, 0 at rest; of a hinged wall 1 */
   int32_t broken; /* committed: 1 when the tendon has broken */
   double u;       /* committed, m */
} rwmf_member_info;

typedef struct {
   double hold[2];    /* smallest and largest force on u at which a wall at rest stays there, N; NaN
                         while it rocks */
   double theta;      /* rad */
   double theta_dot;  /* rad/s */
   double theta_ddot; /* rad/s2 */
   double cable;      /* tension, N */
   double fuses[2];   /* tension of the left and of the right one, N */
} rwmf_member_response;

typedef struct {
   double tau;   /* since the beginning of the step, s; its length without an event */
   int32_t kind; /* RWMF_EVENT_IMPACT, _LIFT_OFF, _PEAK or _BRANCH; 0: none */
   int32_t side; /* of a lift-off; else that of the wall */
} rwmf_member_event;

int rwmf_create_member(const char *namelist, rwmf_member **member, char *message, size_t size);
int rwmf_create_member_from_case(const rwmf_case *scene, rwmf_member **member, char *message,
                                 size_t size);
/* Sets *member to NULL. Safe to call twice. */
void rwmf_destroy_member(rwmf_member **member);
int rwmf_query_member(const rwmf_member *member, rwmf_member_info *info, char *message, size_t size);

/* Resisting forces: `force` has room for n numbers. `tangents` has room for 3*n*n numbers or is NULL:
 * stiffness, damping and mass, row after row, the derivative of force i by the motion of j at i*n + j.
 * `response` may be NULL. At rest u is 0 whatever the motion says; its force, row and column are 0. */
int rwmf_respond_member(rwmf_member *member, const double *motion, const double *ground,
                        double *force, double *tangents, rwmf_member_response *response,
                        char *message, size_t size);
/* Keep the trial state; return to the committed state; return to the initial state. */
int rwmf_commit_member(rwmf_member *member, char *message, size_t size);
int rwmf_revert_member(rwmf_member *member, char *message, size_t size);
int rwmf_restart_member(rwmf_member *member, char *message, size_t size);
/* `*copy` is made when it is NULL, else written over with everything of `member`: this saves a state
 * and restores it. */
int rwmf_copy_member(const rwmf_member *member, rwmf_member **copy, char *message, size_t size);

/* Motion of the wall at its links: 3*links numbers, and their derivatives by the degrees of freedom,
 * links*n numbers, row after row. With rigid links this is the motion of the host's floors. */
int rwmf_query_links(const rwmf_member *member, const double *motion, double *links,
                     double *derivatives, char *message, size_t size);

/* First event of a step of length dt >= 0 from the committed state, from the motions at its ends (6*n
 * numbers) and the ground at its ends (4 numbers). `push` has the forces of the host on u at both ends,
 * for a wall at rest. With `branches` other than 0 ends of branches and the peaks where springs unload
 * are events, too: steps that end there keep the order of the host's method. */
int rwmf_next_member_event(const rwmf_member *member, double dt, const double *motions,
                           const double *ground, const double *push, int branches,
                           rwmf_member_event *event, char *message, size_t size);
/* Impact of a wall that is committed at u = 0: the velocities (n numbers) become those after it, and
 * the side changes, to 0 when both corners stay on the base. `host_mass` has n*n numbers in kg, the
 * masses of the host: the rule 'coupled' balances momentum over them; NULL: the mass ratio of the case.
 * `displacements` has n numbers. */
int rwmf_land_member(rwmf_member *member, const double *displacements, const double *host_mass,
                     double *velocities, int32_t *side, char *message, size_t size);
/* 1 in *rests when the wall that has landed may be put to rest, since the following impacts are below
 * the step dt. Motion, ground and push are those after the impact. */
int rwmf_member_settles(const rwmf_member *member, double dt, const double *motion,
                        const double *ground, double push, const double *host_mass, int32_t *rests,
                        char *message, size_t size);
/* Set the side of a wall that is committed at u = 0: after a lift-off (1 or -1), for rest (0). */
int rwmf_place_member(rwmf_member *member, int side, char *message, size_t size);

#ifdef __cplusplus
}
#endif

#endif
