!> Loops of the series lanes for the processor in use and an order.
!>
!> As in `rwmf_integrator_lane_kernels`, the level of instructions does not affect the bits of a
!> result.
module rwmf_integrator_series_series_kernels
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_lanes, only: series_lanes_t
   use rwmf_integrator_series_series_loops_o10, only: end_o10 => end_steps, &
      expand_o10 => expand_lanes, find_o10 => find_roots, screen_o10 => screen_lanes
   use rwmf_integrator_series_series_loops_o8, only: end_steps, expand_lanes, find_roots, &
      screen_lanes
#ifdef LANE_LEVELS
   use rwmf_integrator_series_series_loops_o10_v3, only: end_o10_v3 => end_steps, &
      expand_o10_v3 => expand_lanes, find_o10_v3 => find_roots, screen_o10_v3 => screen_lanes
   use rwmf_integrator_series_series_loops_o10_v4, only: end_o10_v4 => end_steps, &
      expand_o10_v4 => expand_lanes, find_o10_v4 => find_roots, screen_o10_v4 => screen_lanes
   use rwmf_integrator_series_series_loops_o8_v3, only: end_v3 => end_steps, &
      expand_v3 => expand_lanes, find_v3 => find_roots, screen_v3 => screen_lanes
   use rwmf_integrator_series_series_loops_o8_v4, only: end_v4 => end_steps, &
      expand_v4 => expand_lanes, find_v4 => find_roots, screen_v4 => screen_lanes
#endif
   implicit none
   private

   public :: series_kernels_t, series_kernels_of, series_order

   !> Loops compiled for one instruction set and one order.
   type :: series_kernels_t
      integer :: order = 0
      procedure(loop_i), pointer, nopass :: expand_lanes => null()
      procedure(loop_i), pointer, nopass :: screen_lanes => null()
      procedure(loop_i), pointer, nopass :: find_roots => null()
      procedure(loop_i), pointer, nopass :: end_steps => null()
   end type series_kernels_t

   abstract interface
      !> Loop over all lanes.
      pure subroutine loop_i(lanes)
         import :: series_lanes_t
         implicit none
         type(series_lanes_t), intent(inout) :: lanes
      end subroutine loop_i
   end interface

contains

   !> Order of the series for a tolerance.
   pure integer function series_order(rtol) result(order)
      real(wp), intent(in) :: rtol
      !! [-]

      order = merge(8, 10, rtol >= 1.0e-8_wp)
   end function series_order

   !> Return the loops for an instruction set and an order.
   pure type(series_kernels_t) function series_kernels_of(level, order) result(kernels)
      integer, intent(in) :: level
      !! 1, 3 or 4, at most the level of the processor
      integer, intent(in) :: order
      !! 8 or 10

      select case (order + level)
#ifdef LANE_LEVELS
      case (14)
         kernels = series_kernels_t(order, expand_o10_v4, screen_o10_v4, find_o10_v4, end_o10_v4)
      case (13)
         kernels = series_kernels_t(order, expand_o10_v3, screen_o10_v3, find_o10_v3, end_o10_v3)
      case (12)
         kernels = series_kernels_t(order, expand_v4, screen_v4, find_v4, end_v4)
#endif
      case default
         kernels = series_kernels_t(order, expand_lanes, screen_lanes, find_roots, end_steps)
         if (order == 10) kernels = series_kernels_t(order, expand_o10, screen_o10, find_o10, &
            end_o10)
#ifdef LANE_LEVELS
         if (order == 8 .and. level == 3) kernels = series_kernels_t(order, expand_v3, screen_v3, &
            find_v3, end_v3)
#endif
      end select
   end function series_kernels_of

end module rwmf_integrator_series_series_kernels
