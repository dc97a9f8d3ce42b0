!> Data shared by all ordinates of a fast spectrum: time grids and reduced equations.
module rwmf_spectrum_fast_shared_data
   use rwmf_core_control, only: control_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_spectrum_fast_simd_dispatch, only: kernels_t
   use rwmf_spectrum_fast_time_grid, only: time_grid_t
   use rwmf_spectrum_fast_types, only: ground_step_t, reduced_equation_t, scheme_t
   implicit none
   private

   public :: task_t, ordinate_t, shared_data_t, max_stages, scheme_of

   integer, parameter :: max_stages = 3
   !! largest number of evaluations of N in a step

   !> One ordinate to be computed.
   type :: task_t
      real(wp) :: T_s
      !! [s]
      integer :: equation
      !! number of its reduced equation
      integer :: grid
      !! number of its time grid
      integer :: stages
      !! evaluations of N in a step
      real(wp) :: xi_s
      !! damping ratio of the frame [-]
      real(wp) :: factor = 1
      !! of its motion over that of the grids [-]
   end type task_t

   !> The ordinate in a lane: what only its events need.
   type :: ordinate_t
      integer :: task = 0
      !! number of the task; 0: the lane is idle
      type(reduced_equation_t) :: equation
      !! under the motion of the grids
      integer :: grid
      !! number of the time grid
      integer :: offset
      !! steps of other grids before those of this grid
      real(wp) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp) :: v_max = 0
      !! largest v up to the last impact [-]
      real(wp) :: w_max = 0
      !! largest rate at an impact [1/s]
      real(wp) :: negligible_velocity = 0
      !! rate below which the wall may be put to rest [1/s]
      integer :: uplift = 1
      !! no step before this one, after the present one, lifts the resting wall
      integer :: impacts = 0
      integer(i8) :: repetitions = 0
      !! of the steps after the motion so far
      logical :: failed = .false.
      !! left to the general lanes
   end type ordinate_t

   !> Data shared by all threads.
   type :: shared_data_t
      type(control_t) :: control
      type(kernels_t) :: kernels
      !! for the instruction set of the processor
      real(wp) :: rtol
      !! requested relative tolerance [-]
      type(reduced_equation_t), allocatable :: equation(:)
      type(time_grid_t), allocatable :: grid(:)
      type(ground_step_t), allocatable :: ground(:)
      !! steps of all grids, one after the other, to which the grids point
   end type shared_data_t

contains

   !> What the steps of all ordinates have in common with those of a task.
   pure type(scheme_t) function scheme_of(shared, task) result(scheme)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task

      scheme%stages = task%stages
      scheme%is_short = shared%equation(task%equation)%is_short
      scheme%is_damped = any(abs(shared%equation(task%equation)%coef(:, 5, :)) > 0)
      scheme%is_straight = all(shared%grid%is_straight)
      scheme%has_jumps = any(shared%grid%has_jumps)
   end function scheme_of

end module rwmf_spectrum_fast_shared_data
