!> Columns of the table in which every lane keeps where it is and how far it may go.
module rwmf_integrator_lane_columns
   implicit none
   private

   public :: column_count, screen_t
   public :: of_time, of_limit, of_length, of_trial, of_line, of_vertical_line, of_low, of_high, &
      of_bottom, of_top, of_longest, of_fastest, of_rejected, of_watch, of_goal, of_least, of_most
   public :: of_interval, of_steps, of_pace, of_frequency, of_ground_end, of_plain, of_calm, &
      of_next, of_middle, of_fastest_demand, line_columns
   public :: is_done, is_rejected, needs_look, at_limit

   integer, parameter :: of_time = 1
   !! present time [s]
   integer, parameter :: of_limit = 2
   !! to which it may step: a knot of the motion, or the end [s]
   integer, parameter :: of_length = 3
   !! length of a step that the last estimate of the error allows [s]; 0: the lane is idle
   integer, parameter :: of_trial = 4
   !! length of the step that is tried [s]
   integer, parameter :: of_line = 5
   !! and two more: line of the ground acceleration, a_0 [m/s2], slope [m/s3], t_0 [s]
   integer, parameter :: of_vertical_line = 8
   !! and one more: the same of the vertical acceleration, with the same t_0
   integer, parameter :: of_low = 10
   !! rotation (bare frame: displacement) down to which nothing happens [rad]
   integer, parameter :: of_high = 11
   !! and up to which nothing does [rad]
   integer, parameter :: of_bottom = 12
   !! a turn that may lie below it has to be located [rad]
   integer, parameter :: of_top = 13
   !! and one that may lie above it [rad]
   integer, parameter :: of_longest = 14
   !! step that the events of the lane can be seen in [s]
   integer, parameter :: of_fastest = 15
   !! largest |theta'| at the ends of steps [rad/s]
   integer, parameter :: of_rejected = 16
   !! 1 where the last trial was rejected
   integer, parameter :: of_watch = 17
   !! 1 where every step is looked at
   integer, parameter :: of_goal = 18
   !! length of the step to an event; 0: none is to be met [s]
   integer, parameter :: of_least = 19
   !! value of a further state down to which nothing happens
   integer, parameter :: of_most = 20
   !! and up to which nothing does
   integer, parameter :: of_interval = 21
   !! number of the interval of the motion that the lane is in
   integer, parameter :: of_steps = 22
   !! number of steps that have been accepted
   integer, parameter :: of_pace = 23
   !! steps per rotation that a hysteretic state asks for, which relaxes to its bound [1/rad]
   integer, parameter :: of_frequency = 24
   !! of the fastest vibration [rad/s]
   integer, parameter :: of_ground_end = 25
   !! and one more: acceleration of the ground at the end of the step that was tried last,
   !! horizontal and vertical [m/s2]
   integer, parameter :: of_plain = 27
   !! 1 where the step that is tried holds no extremum of the reactions that are asked for
   integer, parameter :: of_calm = 28
   !! likewise of the demands
   integer, parameter :: of_next = 29
   !! 1 where the ground does not jump at the end of the step that is tried
   integer, parameter :: of_middle = 30
   !! and one more: acceleration of the ground in its middle, horizontal and vertical [m/s2]
   integer, parameter :: of_fastest_demand = 32
   !! frequency of the fastest vibration, that of the wall on springs and cable included [rad/s]
   integer, parameter :: column_count = 32
   integer, parameter :: line_columns = 6
   !! that depend on the interval of the motion: `of_limit` and those of the lines

   !> Requested outputs of the lanes of a batch.
   type :: screen_t
      logical :: is_used = .false.
      logical :: has_reactions = .false.
      logical :: has_demands = .false.
      logical :: has_sampled_reactions = .false.
      !! their ends do not tell enough of a step, because floors move by themselves
      logical :: has_middle = .false.
      !! something is sampled in the middle of each step
      integer :: floors = 0, drifts = 0
      !! numbers of those among the demands
      integer :: n = 0
      !! number of values
      logical, allocatable :: is_led(:)
      !! (values) it is in a fixed proportion to one before it
   end type screen_t

   integer, parameter :: is_done = 0
   !! the step is accepted, and nothing happens in it
   integer, parameter :: is_rejected = 1
   !! its error is too large
   integer, parameter :: needs_look = 2
   !! something may happen in it: it is neither accepted nor rejected yet
   integer, parameter :: at_limit = 3
   !! as `is_done`, and the lane has come to its limit

end module rwmf_integrator_lane_columns
