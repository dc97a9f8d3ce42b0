!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_spectrum_fast_simd_dispatch
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_spectrum_fast_types, only: frame_block_width, ground_step_t, lane_block_t, scheme_t, &
      substep_batch_t, trial_step_t, wp
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

   public :: best_level, instruction_set, advance_block, advance_frames, search_batch, &
      integrate_batch, rebound_batch

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

   !> Instruction set for `advance_block` and the others: 1 (baseline), 3 (AVX2) or 4 (AVX-512).
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

   !> One step of a block. Lanes in which an event is possible keep their state.
   pure subroutine advance_block(level, ground, scheme, lanes, trial, event_bits, needs_update)
      integer, intent(in) :: level
      !! from `best_level`
      type(ground_step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      !! bit i - 1: an event is possible in lane i
      logical, intent(out) :: needs_update
      !! a lane has reached a step of another length, or its end

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call step_block_v4(ground, scheme, lanes, trial, event_bits, needs_update)
      case (3)
         call step_block_v3(ground, scheme, lanes, trial, event_bits, needs_update)
#endif
      case default
         call step_block(ground, scheme, lanes, trial, event_bits, needs_update)
      end select
   end subroutine advance_block

   !> First impact and largest v of whole steps, from their differences of N.
   pure subroutine search_batch(level, batch)
      integer, intent(in) :: level
      !! from `best_level`
      type(substep_batch_t), intent(inout) :: batch

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call expand_steps_v4(batch)
         call locate_events_v4(0, batch)
      case (3)
         call expand_steps_v3(batch)
         call locate_events_v3(0, batch)
#endif
      case default
         call expand_steps(batch)
         call locate_events(0, batch)
      end select
   end subroutine search_batch

   !> Set up the flights that follow the impacts of a batch.
   pure subroutine rebound_batch(level, remainder_share, batch)
      integer, intent(in) :: level
      !! from `best_level`
      real(wp), intent(in) :: remainder_share
      !! change of v by N that is left out, over the largest v [-]
      type(substep_batch_t), intent(inout) :: batch

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call rebound_substeps_v4(remainder_share, batch)
      case (3)
         call rebound_substeps_v3(remainder_share, batch)
#endif
      case default
         call rebound_substeps(remainder_share, batch)
      end select
   end subroutine rebound_batch

   !> Integrate flights that start on the base over their substeps; first impact and largest v.
   pure subroutine integrate_batch(level, batch)
      integer, intent(in) :: level
      !! from `best_level`
      type(substep_batch_t), intent(inout) :: batch

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call integrate_substeps_v4(batch)
         call locate_events_v4(1, batch)
      case (3)
         call integrate_substeps_v3(batch)
         call locate_events_v3(1, batch)
#endif
      case default
         call integrate_substeps(batch)
         call locate_events(1, batch)
      end select
   end subroutine integrate_batch

   !> One step of bare frames, as `step_frames`.
   pure subroutine advance_frames(level, n, h, f, weight, u, w, u_max, event)
      integer, intent(in) :: level
      !! from `best_level`
      integer, intent(in) :: n
      !! lanes in use, a multiple of `block_width`
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: f(0:3)
      !! as in `ground_step_t` [m/s2]
      real(wp), intent(in) :: weight(frame_block_width, 12)
      real(wp), intent(inout) :: u(frame_block_width, 2)
      !! [m]
      real(wp), intent(inout) :: w(frame_block_width, 2)
      !! [m/s]
      real(wp), intent(inout) :: u_max(frame_block_width)
      !! [m]
      real(wp), intent(out) :: event(frame_block_width)

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call step_frames_v4(n, h, f, weight, u, w, u_max, event)
      case (3)
         call step_frames_v3(n, h, f, weight, u, w, u_max, event)
#endif
      case default
         call step_frames(n, h, f, weight, u, w, u_max, event)
      end select
   end subroutine advance_frames

end module rwmf_spectrum_fast_simd_dispatch
