!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_spectrum_fast_simd_dispatch
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_spectrum_fast_event_kernel, only: locate_events
   use rwmf_spectrum_fast_substep_kernel, only: expand_steps, integrate_substeps, rebound_substeps
   use rwmf_spectrum_fast_step_kernel, only: step_block, step_frames
#ifdef FAST_LEVELS
   use FAST_LOCATE_V3, only: locate_events_v3 => locate_events
   use FAST_PIECE_V3, only: expand_steps_v3 => expand_steps, &
      integrate_substeps_v3 => integrate_substeps, rebound_substeps_v3 => rebound_substeps
   use FAST_LOCATE_V4, only: locate_events_v4 => locate_events
   use FAST_PIECE_V4, only: expand_steps_v4 => expand_steps, &
      integrate_substeps_v4 => integrate_substeps, rebound_substeps_v4 => rebound_substeps
   use FAST_STEP_V3, only: step_block_v3 => step_block, step_frames_v3 => step_frames
   use FAST_STEP_V4, only: step_block_v4 => step_block, step_frames_v4 => step_frames
#endif
   implicit none
   private

   public :: kernels_t, kernels_of, best_level, instruction_set

   !> The loops, compiled for one instruction set.
   type :: kernels_t
      procedure(step_block), pointer, nopass :: step_block => null()
      procedure(step_frames), pointer, nopass :: step_frames => null()
      procedure(expand_steps), pointer, nopass :: expand_steps => null()
      procedure(integrate_substeps), pointer, nopass :: integrate_substeps => null()
      procedure(rebound_substeps), pointer, nopass :: rebound_substeps => null()
      procedure(locate_events), pointer, nopass :: locate_events => null()
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
         kernels = kernels_t(step_block_v4, step_frames_v4, expand_steps_v4, &
            integrate_substeps_v4, rebound_substeps_v4, locate_events_v4)
      case (3)
         kernels = kernels_t(step_block_v3, step_frames_v3, expand_steps_v3, &
            integrate_substeps_v3, rebound_substeps_v3, locate_events_v3)
#endif
      case default
         kernels = kernels_t(step_block, step_frames, expand_steps, integrate_substeps, &
            rebound_substeps, locate_events)
      end select
   end function kernels_of

end module rwmf_spectrum_fast_simd_dispatch
