!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_spectrum_fast_simd_dispatch
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_spectrum_fast_event_kernel, only: follow_steps
   use rwmf_spectrum_fast_step_kernel, only: step_team
#ifdef FAST_LEVELS
   use rwmf_spectrum_fast_event_kernel_v3, only: follow_steps_v3 => follow_steps
   use rwmf_spectrum_fast_event_kernel_v4, only: follow_steps_v4 => follow_steps
   use rwmf_spectrum_fast_step_kernel_v3, only: step_team_v3 => step_team
   use rwmf_spectrum_fast_step_kernel_v4, only: step_team_v4 => step_team
#endif
   implicit none
   private

   public :: kernels_t, kernels_of, best_level, instruction_set

   !> The loops, compiled for one instruction set.
   type :: kernels_t
      procedure(step_team), pointer, nopass :: step_team => null()
      procedure(follow_steps), pointer, nopass :: follow_steps => null()
   end type kernels_t

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

   !> Instruction set of this processor: 1 (baseline), 3 (AVX2) or 4 (AVX-512).
   integer function best_level() result(level)
      level = 1
#ifdef FAST_LEVELS
      level = int(processor_level())
#endif
   end function best_level

   !> Name of the instructions that method 'fast' uses on this processor.
   function instruction_set() result(name)
      character(9) :: name
      !! 'x86-64', 'x86-64-v3' (AVX2), 'x86-64-v4' (AVX-512); elsewhere 'generic'

      name = 'generic'
#ifdef FAST_LEVELS
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

   !> The loops for an instruction set.
   pure type(kernels_t) function kernels_of(level) result(kernels)
      integer, intent(in) :: level
      !! 1, 3 or 4, at most `best_level`

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         kernels = kernels_t(step_team_v4, follow_steps_v4)
      case (3)
         kernels = kernels_t(step_team_v3, follow_steps_v3)
#endif
      case default
         kernels = kernels_t(step_team, follow_steps)
      end select
   end function kernels_of

end module rwmf_spectrum_fast_simd_dispatch
