!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_spectrum_fast_simd_dispatch
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_spectrum_fast_types, only: flights_t, lanes, scheme_t, step_t, team_t, tried_step_t, wp
   use rwmf_spectrum_fast_event_kernel, only: locate_events
   use rwmf_spectrum_fast_substep_kernel, only: depart_flights, follow_flights, rebound_flights
   use rwmf_spectrum_fast_step_kernel, only: advance_team, step_frames
#ifdef FAST_LEVELS
   use FAST_LOCATE_V3, only: locate_events_v3 => locate_events
   use FAST_PIECE_V3, only: depart_flights_v3 => depart_flights, &
      follow_flights_v3 => follow_flights, rebound_flights_v3 => rebound_flights
   use FAST_LOCATE_V4, only: locate_events_v4 => locate_events
   use FAST_PIECE_V4, only: depart_flights_v4 => depart_flights, &
      follow_flights_v4 => follow_flights, rebound_flights_v4 => rebound_flights
   use FAST_STEP_V3, only: advance_team_v3 => advance_team, step_frames_v3 => step_frames
   use FAST_STEP_V4, only: advance_team_v4 => advance_team, step_frames_v4 => step_frames
#endif
   implicit none
   private

   public :: best_level, instruction_set, advance, advance_frames, follow, depart, rebound

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

   !> Instruction set for `advance` and the others: 1 (baseline), 3 (AVX2) or 4 (AVX-512).
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

   !> One step of a team. The lanes in which something may happen are left as they were.
   pure subroutine advance(level, ground, scheme, team, trial, marks, is_called)
      integer, intent(in) :: level
      !! from `best_level`
      type(step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      !! bit i - 1: something may happen in lane i
      logical, intent(out) :: is_called
      !! the next step of a lane may be another one than the last

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call advance_team_v4(ground, scheme, team, trial, marks, is_called)
      case (3)
         call advance_team_v3(ground, scheme, team, trial, marks, is_called)
#endif
      case default
         call advance_team(ground, scheme, team, trial, marks, is_called)
      end select
   end subroutine advance

   !> Series of whole steps whose differences of N are known; first impact and largest value.
   pure subroutine follow(level, flights)
      integer, intent(in) :: level
      !! from `best_level`
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call follow_flights_v4(flights)
         call locate_events_v4(0, flights)
      case (3)
         call follow_flights_v3(flights)
         call locate_events_v3(0, flights)
#endif
      case default
         call follow_flights(flights)
         call locate_events(0, flights)
      end select
   end subroutine follow

   !> The flights that follow the impacts.
   pure subroutine rebound(level, negligible, flights)
      integer, intent(in) :: level
      !! from `best_level`
      real(wp), intent(in) :: negligible
      !! change of v by N over the largest v [-]
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call rebound_flights_v4(negligible, flights)
      case (3)
         call rebound_flights_v3(negligible, flights)
#endif
      case default
         call rebound_flights(negligible, flights)
      end select
   end subroutine rebound

   !> Integrate from the base over a part of the step; first impact and largest value.
   pure subroutine depart(level, flights)
      integer, intent(in) :: level
      !! from `best_level`
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call depart_flights_v4(flights)
         call locate_events_v4(1, flights)
      case (3)
         call depart_flights_v3(flights)
         call locate_events_v3(1, flights)
#endif
      case default
         call depart_flights(flights)
         call locate_events(1, flights)
      end select
   end subroutine depart

   !> One step of bare frames.
   pure subroutine advance_frames(level, n, h, f, weight, u, w, u_max, event)
      integer, intent(in) :: level
      !! from `best_level`
      integer, intent(in) :: n
      !! lanes in use, a multiple of `width`
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: f(0:3)
      !! as in `step_t` [m/s2]
      real(wp), intent(in) :: weight(lanes, 12)
      real(wp), intent(inout) :: u(lanes, 2)
      !! [m]
      real(wp), intent(inout) :: w(lanes, 2)
      !! [m/s]
      real(wp), intent(inout) :: u_max(lanes)
      !! [m]
      real(wp), intent(out) :: event(lanes)

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
