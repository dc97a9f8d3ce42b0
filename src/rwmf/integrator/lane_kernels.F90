!> Step procedures of sixteen lanes for the processor in use.
!>
!> On x86-64 they are compiled three times: for the baseline (two lanes per instruction), for AVX2
!> (four) and for AVX-512 (eight). The choice is made at run time and does not affect the bits of a
!> result.
module rwmf_integrator_lane_kernels
#ifdef LANE_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_integrator_lane_control_l16, only: accept_or_reject, advance_intervals, plan_step
   use rwmf_integrator_lane_quiet_l16, only: find_quiet_steps
   use rwmf_integrator_lane_screens_l16, only: screen_steps
   use rwmf_integrator_lane_step_l16, only: attempt_step
   use rwmf_model_lanes_l16, only: batch_width => lane_count
#ifdef LANE_LEVELS
   use rwmf_integrator_lane_control_l16_v3, only: accept_or_reject_v3 => accept_or_reject, &
      advance_intervals_v3 => advance_intervals, plan_step_v3 => plan_step
   use rwmf_integrator_lane_control_l16_v4, only: accept_or_reject_v4 => accept_or_reject, &
      advance_intervals_v4 => advance_intervals, plan_step_v4 => plan_step
   use rwmf_integrator_lane_quiet_l16_v3, only: find_quiet_steps_v3 => find_quiet_steps
   use rwmf_integrator_lane_quiet_l16_v4, only: find_quiet_steps_v4 => find_quiet_steps
   use rwmf_integrator_lane_screens_l16_v3, only: screen_steps_v3 => screen_steps
   use rwmf_integrator_lane_screens_l16_v4, only: screen_steps_v4 => screen_steps
   use rwmf_integrator_lane_step_l16_v3, only: attempt_step_v3 => attempt_step
   use rwmf_integrator_lane_step_l16_v4, only: attempt_step_v4 => attempt_step
#endif
   implicit none
   private

   public :: lane_kernels_t, lane_kernels_of, batch_width, best_level, instruction_set

   !> Step procedures compiled for one instruction set.
   type :: lane_kernels_t
      procedure(plan_step), pointer, nopass :: plan_step => null()
      procedure(attempt_step), pointer, nopass :: attempt_step => null()
      procedure(accept_or_reject), pointer, nopass :: accept_or_reject => null()
      procedure(advance_intervals), pointer, nopass :: advance_intervals => null()
      procedure(find_quiet_steps), pointer, nopass :: find_quiet_steps => null()
      procedure(screen_steps), pointer, nopass :: screen_steps => null()
   end type lane_kernels_t

#ifdef LANE_LEVELS
   interface
      !> x86-64 level of this processor with compiled code: 1, 3 or 4.
      function processor_level() bind(c, name='rwmf_processor_level') result(level)
         import :: c_int
         implicit none
         integer(c_int) :: level
      end function processor_level
   end interface
#endif

contains

   !> Instruction set of this processor: 1 (baseline), 3 (AVX2) or 4 (AVX-512).
   integer function best_level() result(level)
      level = 1
#ifdef LANE_LEVELS
      level = int(processor_level())
#endif
   end function best_level

   !> Name of the instruction set that spectra use on this processor.
   function instruction_set() result(name)
      character(9) :: name
      !! 'x86-64', 'x86-64-v3' (AVX2), 'x86-64-v4' (AVX-512); elsewhere 'generic'

      name = 'generic'
#ifdef LANE_LEVELS
      select case (best_level())
      case (4)
         name = 'x86-64-v4'
      case (3)
         name = 'x86-64-v3'
      case default
         name = 'x86-64'
      end select
#endif
   end function instruction_set

   !> Return the step procedures for an instruction set.
   pure type(lane_kernels_t) function lane_kernels_of(level) result(kernels)
      integer, intent(in) :: level
      !! 1, 3 or 4, at most the level of the processor

      select case (level)
#ifdef LANE_LEVELS
      case (4)
         kernels = lane_kernels_t(plan_step_v4, attempt_step_v4, accept_or_reject_v4, &
            advance_intervals_v4, find_quiet_steps_v4, screen_steps_v4)
      case (3)
         kernels = lane_kernels_t(plan_step_v3, attempt_step_v3, accept_or_reject_v3, &
            advance_intervals_v3, find_quiet_steps_v3, screen_steps_v3)
#endif
      case default
         kernels = lane_kernels_t(plan_step, attempt_step, accept_or_reject, advance_intervals, &
            find_quiet_steps, screen_steps)
      end select
   end function lane_kernels_of

end module rwmf_integrator_lane_kernels
