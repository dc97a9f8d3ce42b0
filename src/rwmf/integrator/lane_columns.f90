!> Columns of the table with the state and the limits of every lane.
module rwmf_integrator_lane_columns
   implicit none
   private

   public :: column_count, screen_t
   public :: of_time, of_limit, of_length, of_trial, of_line, of_vertical_line, of_low, of_high, &
      of_bottom, of_top, of_longest, of_fastest, of_rejected, of_inspection, of_target, of_least, &
      of_most
   public :: of_interval, of_steps, of_max_rate, of_frequency, of_ground_end, of_plain, of_calm, &
      of_next, of_middle, of_fastest_demand, line_columns
   public :: is_done, is_rejected, needs_inspection, at_limit

   integer, parameter :: of_time = 1
   !! current time [s]
   integer, parameter :: of_limit = 2
   !! latest end of the next step, a knot of the motion or the end [s]
   integer, parameter :: of_length = 3
   !! length of a step that the last error estimate allows [s]; 0 for an idle lane
   integer, parameter :: of_trial = 4
   !! length of the attempted step [s]
   integer, parameter :: of_line = 5
   !! first of three columns: line of the ground acceleration, a_0 [m/s2], slope [m/s3], t_0 [s]
   integer, parameter :: of_vertical_line = 8
   !! first of two columns: a_0 and slope of the vertical acceleration, with the same t_0
   integer, parameter :: of_low = 10
   !! lower limit of the rotation (bare frame: displacement) without an event [rad]
   integer, parameter :: of_high = 11
   !! upper limit of the rotation without an event [rad]
   integer, parameter :: of_bottom = 12
   !! turning points that may be below it are located [rad]
   integer, parameter :: of_top = 13
   !! turning points that may be above it are located [rad]
   integer, parameter :: of_longest = 14
   !! longest step that resolves the events of the lane [s]
   integer, parameter :: of_fastest = 15
   !! largest |theta'| at the ends of steps [rad/s]
   integer, parameter :: of_rejected = 16
   !! 1 if the last attempt was rejected
   integer, parameter :: of_inspection = 17
   !! 1 if every step is inspected
   integer, parameter :: of_target = 18
   !! length of the step to an event; 0 without a target event [s]
   integer, parameter :: of_least = 19
   !! lower limit of a further state without an event
   integer, parameter :: of_most = 20
   !! upper limit of a further state without an event
   integer, parameter :: of_interval = 21
   !! number of the current interval of the motion
   integer, parameter :: of_steps = 22
   !! number of accepted steps
   integer, parameter :: of_max_rate = 23
   !! steps per rotation that a hysteretic state needs while it relaxes to its bound [1/rad]
   integer, parameter :: of_frequency = 24
   !! frequency of the fastest vibration [rad/s]
   integer, parameter :: of_ground_end = 25
   !! first of two columns: ground acceleration at the end of the last attempted step, horizontal
   !! and vertical [m/s2]
   integer, parameter :: of_plain = 27
   !! 1 if the attempted step has no extremum of the requested reactions
   integer, parameter :: of_calm = 28
   !! 1 if the attempted step has no extremum of the requested demands
   integer, parameter :: of_next = 29
   !! 1 if the ground does not jump at the end of the attempted step
   integer, parameter :: of_middle = 30
   !! first of two columns: ground acceleration in the middle of the attempted step, horizontal and
   !! vertical [m/s2]
   integer, parameter :: of_fastest_demand = 32
   !! frequency of the fastest vibration, including that of the wall on springs and tendon [rad/s]
   integer, parameter :: column_count = 32
   integer, parameter :: line_columns = 6
   !! number of columns that depend on the interval of the motion: `of_limit` and the lines

   !> Requested outputs of the lanes of a batch.
   type :: screen_t
      logical :: is_used = .false.
      logical :: has_reactions = .false.
      logical :: has_demands = .false.
      integer :: floors = 0, drifts = 0
      !! numbers of floors and drifts among the demands
      integer :: n = 0
      !! number of values
      integer :: columns = 0
      !! number of values and of coefficients of section forces
      logical, allocatable :: is_led(:)
      !! (values) the value is in a fixed proportion to one before it
   end type screen_t

   integer, parameter :: is_done = 0
   !! the step is accepted and has no event
   integer, parameter :: is_rejected = 1
   !! the error of the step is too large
   integer, parameter :: needs_inspection = 2
   !! the step may have an event and is neither accepted nor rejected yet
   integer, parameter :: at_limit = 3
   !! as `is_done`, with the lane at its limit

end module rwmf_integrator_lane_columns
