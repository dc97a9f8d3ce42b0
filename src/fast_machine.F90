!> The vectorised loops for the processor at hand.
!>
!> On x86-64 they are compiled three times: for every such processor (two lanes an instruction),
!> with AVX2 (four) and with AVX-512 (eight). The choice is made at run time and changes no bit of a
!> result.
module rwmf_fast_machine
#ifdef FAST_LEVELS
   use, intrinsic :: iso_c_binding, only: c_int
#endif
   use rwmf_fast_lanes, only: fast_law_t, flights_t, lane_rate_t, lane_state_t, lanes, step_t, wp
   use rwmf_fast_locate, only: locate_events
   use rwmf_fast_piece, only: depart_flights, follow_flights
   use rwmf_fast_step, only: settle_lanes, step_frames, step_lanes
#ifdef FAST_LEVELS
   use FAST_LOCATE_V3, only: locate_events_v3 => locate_events
   use FAST_PIECE_V3, only: depart_flights_v3 => depart_flights, &
      follow_flights_v3 => follow_flights
   use FAST_LOCATE_V4, only: locate_events_v4 => locate_events
   use FAST_PIECE_V4, only: depart_flights_v4 => depart_flights, &
      follow_flights_v4 => follow_flights
   use FAST_STEP_V3, only: settle_lanes_v3 => settle_lanes, step_frames_v3 => step_frames, &
      step_lanes_v3 => step_lanes
   use FAST_STEP_V4, only: settle_lanes_v4 => settle_lanes, step_frames_v4 => step_frames, &
      step_lanes_v4 => step_lanes
#endif
   implicit none
   private

   public :: best_level, instruction_set, advance_lanes, advance_frames, follow, depart, locate

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

   !> One step of all lanes; those in which something may happen are marked and left as they were.
   pure subroutine advance_lanes(level, n, rate, step, awake, now, next, difference, v_max, &
      worst, event)
      integer, intent(in) :: level
      !! from `best_level`
      integer, intent(in) :: n
      !! lanes in use, a multiple of `width`
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
      real(wp), intent(inout) :: worst(lanes)
      !! doubt when `v_max` was reached [1/s]
      real(wp), intent(out) :: event(lanes)
      !! 1: something may happen in the step

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call step_lanes_v4(n, rate, step, now, next, difference)
         call settle_lanes_v4(n, step%h, awake, rate%keep, next, now, v_max, worst, &
            event)
      case (3)
         call step_lanes_v3(n, rate, step, now, next, difference)
         call settle_lanes_v3(n, step%h, awake, rate%keep, next, now, v_max, worst, &
            event)
#endif
      case default
         call step_lanes(n, rate, step, now, next, difference)
         call settle_lanes(n, step%h, awake, rate%keep, next, now, v_max, worst, &
            event)
      end select
   end subroutine advance_lanes

   !> Series of whole steps whose differences of N are known.
   pure subroutine follow(level, law, step, flights)
      integer, intent(in) :: level
      !! from `best_level`
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call follow_flights_v4(law, step, flights)
      case (3)
         call follow_flights_v3(law, step, flights)
#endif
      case default
         call follow_flights(law, step, flights)
      end select
   end subroutine follow

   !> Integrate from the base over a part of the step.
   pure subroutine depart(level, law, step, flights)
      integer, intent(in) :: level
      !! from `best_level`
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call depart_flights_v4(law, step, flights)
      case (3)
         call depart_flights_v3(law, step, flights)
#endif
      case default
         call depart_flights(law, step, flights)
      end select
   end subroutine depart

   !> First impact and largest value of the flights.
   pure subroutine locate(level, first, flights)
      integer, intent(in) :: level
      !! from `best_level`
      integer, intent(in) :: first
      !! 0: all start in the air, 1: all start on the base
      type(flights_t), intent(inout) :: flights

      select case (level)
#ifdef FAST_LEVELS
      case (4)
         call locate_events_v4(first, flights)
      case (3)
         call locate_events_v3(first, flights)
#endif
      case default
         call locate_events(first, flights)
      end select
   end subroutine locate

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

end module rwmf_fast_machine
