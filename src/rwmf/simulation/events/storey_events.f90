!> Ends of the branches of storeys that yield, inside the last step of an integrator.
!>
!> A part of the step is so short that a storey turns at most twice in it. The step is cut at the
!> first end of a branch, so that whoever searches it afterwards sees one smooth equation.
module rwmf_simulation_events_storey_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_math_roots, only: close_in, secant_between, secant_t
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_effects_storeys_yielding_storeys, only: branch_limits, hysteretic_states, &
      loading_direction_of, pass_storey_limit, side_beyond_zero, stands_still, stop_at_zero, &
      storey_motion, turn_storey
   use rwmf_simulation_events_event_time, only: count_parts
   implicit none
   private

   public :: moment_t, storey_end_t, sample_storeys, find_root, find_turn, stop_at_storey, &
      end_branch
   public :: of_drift, of_rate

   integer, parameter :: of_drift = 1
   integer, parameter :: of_rate = 2
   integer, parameter :: of_z = 3

   !> The storeys at an instant.
   type :: moment_t
      real(wp) :: t
      !! [s]
      real(wp), allocatable :: motion(:, :)
      !! (n, 3) displacements [m], their rates [m/s], and hysteretic states of smooth storeys [-]
   end type moment_t

   !> End of a storey's branch.
   type :: storey_end_t
      integer :: storey = 0
      !! 0: none
      logical :: turns = .false.
      !! it unloads, or begins to move
      logical :: passes_zero = .false.
      !! its hysteretic force does; else it comes to a limit
      logical :: is_rising = .false.
      !! its displacement grows beyond
   end type storey_end_t

contains

   !> Cut the last step of the integrator at the first end of a branch.
   subroutine stop_at_storey(equation, integrator, found, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(storey_end_t), intent(out) :: found
      type(error_t), allocatable, intent(out) :: error
      type(moment_t) :: a
      type(moment_t) :: b
      real(wp) :: t_end
      real(wp) :: t_stop
      real(wp) :: y(equation%n)
      integer :: n, i

      n = count_parts(equation, integrator%t0, integrator%t1)
      if (n == 1) then
         if (is_quiet(equation, integrator)) return
      end if
      t_end = integrator%t1
      t_stop = t_end
      call sample_storeys(equation, integrator, integrator%t0, b, error)
      do i = 1, n
         a = b
         if (allocated(error)) return
         call sample_storeys(equation, integrator, merge(t_end, &
            integrator%t0 + i*((t_end - integrator%t0)/n), i == n), b, error)
         if (allocated(error)) return
         call search_storeys(equation, integrator, a, b, found, t_stop, error)
         if (allocated(error)) return
         if (found%storey > 0) exit
      end do
      if (found%storey == 0) return
      call integrator%state_at(t_stop, y, error)
      integrator%t1 = t_stop
      integrator%y1(:) = y
   end subroutine stop_at_storey

   !> Is it plain from the ends of a short step that no branch ends in it? Most are: the storey is
   !> far from the limits, or yields on at a rate that hardly changes.
   logical function is_quiet(equation, integrator)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(in) :: integrator
      real(wp) :: a(equation%floors%n, 2)
      real(wp) :: b(equation%floors%n, 2)
      real(wp) :: z(equation%floors%n)
      real(wp) :: rate(2)
      real(wp) :: low
      real(wp) :: high
      integer :: loading_direction
      integer :: i

      call storey_motion(equation, integrator%y0, a(:, of_drift), a(:, of_rate))
      call storey_motion(equation, integrator%y1, b(:, of_drift), b(:, of_rate))
      z = hysteretic_states(equation, integrator%y1)
      is_quiet = .true.
      do i = 1, size(a, 1)
         rate = [a(i, of_rate), b(i, of_rate)]
         loading_direction = loading_direction_of(equation, i)
         if (stands_still(equation, i)) then
            is_quiet = abs(rate(2)) <= 0
         else if (loading_direction /= 0) then
            is_quiet = 2*abs(rate(2) - rate(1)) < minval(loading_direction*rate) &
               .and. side_beyond_zero(equation, i)*z(i) <= 0
         else
            call branch_limits(equation, i, low, high)
            associate (reach => (integrator%t1 - integrator%t0)*maxval(abs(rate)))
               is_quiet = max(a(i, of_drift), b(i, of_drift)) + reach < high &
                  .and. min(a(i, of_drift), b(i, of_drift)) - reach > low
            end associate
         end if
         if (.not. is_quiet) return
      end do
   end function is_quiet

   !> First end of a branch between two instants.
   subroutine search_storeys(equation, integrator, a, b, found, t_stop, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      type(storey_end_t), intent(inout) :: found
      real(wp), intent(inout) :: t_stop
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(storey_end_t) :: ending
      real(wp) :: t
      integer :: i

      do i = 1, equation%floors%n
         if (stands_still(equation, i)) then
            ending = storey_end_t(merge(i, 0, abs(b%motion(i, of_rate)) > 0), turns=.true., &
               is_rising=b%motion(i, of_rate) > 0)
            t = a%t
         else if (loading_direction_of(equation, i) /= 0) then
            call search_turn(equation, integrator, i, a, b, ending, t, error)
         else
            call search_limit(equation, integrator, i, a, b, ending, t, error)
         end if
         if (allocated(error)) return
         call keep_first(ending, t)
         call search_zero(equation, integrator, i, a, b, ending, t, error)
         if (allocated(error)) return
         call keep_first(ending, t)
      end do

   contains

      subroutine keep_first(ending, t)
         type(storey_end_t), intent(in) :: ending
         real(wp), intent(in) :: t
         !! [s]

         if (ending%storey == 0) return
         if (found%storey > 0 .and. t >= t_stop) return
         found = ending
         t_stop = t
      end subroutine keep_first
   end subroutine search_storeys

   !> Does a storey that yields turn back?
   subroutine search_turn(equation, integrator, storey, a, b, ending, t, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      type(storey_end_t), intent(out) :: ending
      real(wp), intent(out) :: t
      type(error_t), allocatable, intent(out) :: error
      type(moment_t) :: slowest
      integer :: loading_direction

      t = a%t
      loading_direction = loading_direction_of(equation, storey)
      slowest = b
      if (loading_direction*b%motion(storey, of_rate) >= 0) then
         call look_at_slowest(equation, integrator, storey, a, b, slowest, error)
         if (allocated(error)) return
         if (loading_direction*slowest%motion(storey, of_rate) >= 0) return
      end if
      ending = storey_end_t(storey, turns=.true., is_rising=loading_direction < 0)
      if (loading_direction*a%motion(storey, of_rate) <= 0) return
      call find_root(equation, integrator, storey, of_rate, 0.0_wp, a, slowest, t, error)
   end subroutine search_turn

   !> Does the hysteretic force of a smooth storey pass zero?
   subroutine search_zero(equation, integrator, storey, a, b, ending, t, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      type(storey_end_t), intent(out) :: ending
      real(wp), intent(out) :: t
      type(error_t), allocatable, intent(out) :: error
      integer :: side

      t = a%t
      side = side_beyond_zero(equation, storey)
      if (side*b%motion(storey, of_z) <= 0) return
      ending = storey_end_t(storey, passes_zero=.true.)
      if (side*a%motion(storey, of_z) >= 0) return
      call find_root(equation, integrator, storey, of_z, 0.0_wp, a, b, t, error)
   end subroutine search_zero

   !> The instant between two at which a storey is about slowest, if it may turn back there and go
   !> on again; else the second one.
   !>
   !> A rate that touches zero as a parabola has the mean (v_a + v_b - sqrt(v_a v_b))/3: only below
   !> that, with a margin, another state is asked for.
   subroutine look_at_slowest(equation, integrator, storey, a, b, slowest, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      type(moment_t), intent(inout) :: slowest
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: margin = 0.45_wp
      real(wp) :: rate(2)
      real(wp) :: way
      real(wp) :: x
      !! place of the parabola's vertex between both [-]

      rate = abs([a%motion(storey, of_rate), b%motion(storey, of_rate)])
      way = abs(b%motion(storey, of_drift) - a%motion(storey, of_drift))
      if (way >= margin*(b%t - a%t)*(sum(rate) - sqrt(rate(1))*sqrt(rate(2)))) return
      x = sqrt(rate(1))/max(sqrt(rate(1)) + sqrt(rate(2)), tiny(x))
      call sample_storeys(equation, integrator, a%t + x*(b%t - a%t), slowest, error)
   end subroutine look_at_slowest

   !> Does an elastic storey come to a limit?
   subroutine search_limit(equation, integrator, storey, a, b, ending, t, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      type(storey_end_t), intent(out) :: ending
      real(wp), intent(out) :: t
      type(error_t), allocatable, intent(out) :: error
      type(moment_t) :: turn
      real(wp) :: low
      real(wp) :: high

      t = a%t
      call branch_limits(equation, storey, low, high)
      call find_turn(equation, integrator, storey, a, b, low, high, turn, error)
      if (allocated(error)) return
      if (turn%t < b%t) call pass_limit(turn)
      if (ending%storey > 0 .or. allocated(error)) return
      call pass_limit(b)

   contains

      !> A limit between the beginning and another instant.
      subroutine pass_limit(last)
         type(moment_t), intent(in) :: last
         type(moment_t) :: first
         real(wp) :: limit
         integer :: outward

         associate (d => last%motion(storey, of_drift))
            if (d <= high .and. d >= low) return
            outward = merge(1, -1, d > high)
            limit = merge(high, low, d > high)
         end associate
         first = a
         if (is_beyond(first, limit, outward) .and. is_inward(first, outward)) then
            ! it begins at the limit, where it has turned, and has to turn once more
            if (is_inward(last, outward)) return
            call find_root(equation, integrator, storey, of_rate, 0.0_wp, a, last, t, error)
            if (.not. allocated(error)) call sample_storeys(equation, integrator, t, first, error)
            if (allocated(error)) return
         end if
         ending = storey_end_t(storey, turns=.false., is_rising=outward > 0)
         if (is_beyond(first, limit, outward)) return
         call find_root(equation, integrator, storey, of_drift, limit, first, last, t, error)
      end subroutine pass_limit

      pure logical function is_beyond(now, limit, outward)
         type(moment_t), intent(in) :: now
         real(wp), intent(in) :: limit
         integer, intent(in) :: outward

         is_beyond = outward*(now%motion(storey, of_drift) - limit) >= 0
      end function is_beyond

      pure logical function is_inward(now, outward)
         type(moment_t), intent(in) :: now
         integer, intent(in) :: outward

         is_inward = outward*now%motion(storey, of_rate) < 0
      end function is_inward
   end subroutine search_limit

   !> The turn of a storey between two instants, if it may lie outside of two limits; else the
   !> second instant.
   subroutine find_turn(equation, integrator, storey, a, b, low, high, turn, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      real(wp), intent(in) :: low
      !! [m]
      real(wp), intent(in) :: high
      !! [m]
      type(moment_t), intent(out) :: turn
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: reach
      !! how far it may go beyond its ends, twice what a steady deceleration allows [m]
      real(wp) :: t

      turn = b
      associate (d => [a%motion(storey, of_drift), b%motion(storey, of_drift)], &
         rate => [a%motion(storey, of_rate), b%motion(storey, of_rate)])
         if (rate(1)*rate(2) >= 0) return
         reach = (b%t - a%t)*maxval(abs(rate))
         if (rate(1) > 0 .and. maxval(d) + reach <= high) return
         if (rate(1) < 0 .and. minval(d) - reach >= low) return
      end associate
      call find_root(equation, integrator, storey, of_rate, 0.0_wp, a, b, t, error)
      if (allocated(error)) return
      call sample_storeys(equation, integrator, t, turn, error)
   end subroutine find_turn

   !> Where displacement or rate of a storey passes a level, to round-off of the time.
   subroutine find_root(equation, integrator, storey, which, level, a, b, t, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: storey
      integer, intent(in) :: which
      !! `of_drift` or `of_rate`
      real(wp), intent(in) :: level
      !! [m] or [m/s]
      type(moment_t), intent(in) :: a
      type(moment_t), intent(in) :: b
      !! on the other side of the level
      real(wp), intent(out) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(secant_t) :: secant
      type(moment_t) :: now
      real(wp) :: g

      secant = secant_between([a%t, b%t], &
         [a%motion(storey, which), b%motion(storey, which)] - level)
      do while (secant%is_open)
         t = secant%next
         call sample_storeys(equation, integrator, t, now, error)
         if (allocated(error)) return
         g = now%motion(storey, which) - level
         if (abs(g) <= 0) return
         call close_in(secant, g)
      end do
      t = secant%x(2)
   end subroutine find_root

   !> The storeys at a time of the last step.
   subroutine sample_storeys(equation, integrator, t, now, error)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: t
      !! [s]
      type(moment_t), intent(out) :: now
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(equation%n)

      if (t <= integrator%t0) then
         y = integrator%y0
      else if (t >= integrator%t1) then
         y = integrator%y1
      else
         call integrator%state_at(t, y, error)
         if (allocated(error)) return
      end if
      now%t = t
      allocate (now%motion(equation%floors%n, 3))
      call storey_motion(equation, y, now%motion(:, of_drift), now%motion(:, of_rate))
      now%motion(:, of_z) = hysteretic_states(equation, y)
   end subroutine sample_storeys

   !> The storey whose branch has ended goes over to its next one.
   subroutine end_branch(equation, ending, y)
      type(equation_t), intent(inout) :: equation
      type(storey_end_t), intent(in) :: ending
      real(wp), intent(inout) :: y(:)
      !! (states)

      if (ending%turns) then
         call turn_storey(equation, ending%storey, ending%is_rising, y)
      else if (ending%passes_zero) then
         call stop_at_zero(equation, ending%storey, y)
      else
         call pass_storey_limit(equation, ending%storey, ending%is_rising)
      end if
   end subroutine end_branch

end module rwmf_simulation_events_storey_events
