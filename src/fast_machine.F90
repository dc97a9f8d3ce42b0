!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_fast_machine
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_fast_lanes, only: lane_rate_t, lane_state_t, lanes, step_t, wp
   use rwmf_fast_step, only: settle_lanes, step_lanes
#ifdef FAST_LEVELS
   use FAST_STEP_V3, only: settle_lanes_v3 => settle_lanes, step_lanes_v3 => step_lanes
   use FAST_STEP_V4, only: settle_lanes_v4 => settle_lanes, step_lanes_v4 => step_lanes
#endif
   implicit none
   private

   public :: best_level, advance_lanes

#ifdef FAST_LEVELS
   interface
      !> 1, 3 or 4: the x86-64 level of this processor that the kernel has code for.
      function processor_level() bind(c, name='rwmf_processor_level') result(level)
         import :: c_int
         implicit none
         integer(c_int) :: level
      end function processor_level
   end interface
#endif

contains

   !> Instruction set for `advance_lanes`: 1 (baseline), 3 (AVX2) or 4 (AVX-512).
   integer function best_level() result(level)
      level = 1
#ifdef FAST_LEVELS
      level = int(processor_level())
#endif
   end function best_level

   !> One step of all lanes; those in which something may happen are marked and left as they were.
   pure subroutine advance_lanes(level, rate, step, awake, now, next, difference, v_max, event)
      integer, intent(in) :: level
      !! from `best_level`
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: awake(lanes)
      !! 1 in motion, 0 at rest
      type(lane_state_t), intent(inout) :: now
      type(lane_state_t), intent(inout) :: next
      !! as if nothing happened
      real(wp), intent(inout) :: difference(lanes, 0:3)
      !! divided differences of N [1/s2]
      real(wp), intent(inout) :: v_max(lanes)
      !! [-]
      real(wp), intent(out) :: event(lanes)
      !! 1: something may happen in the step

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call step_lanes_v4(rate, step, now, next, difference)
         call settle_lanes_v4(step%h, awake, next, now, v_max, event)
      case (3)
         call step_lanes_v3(rate, step, now, next, difference)
         call settle_lanes_v3(step%h, awake, next, now, v_max, event)
#endif
      case default
         call step_lanes(rate, step, now, next, difference)
         call settle_lanes(step%h, awake, next, now, v_max, event)
      end select
   end subroutine advance_lanes

end module rwmf_fast_machine
