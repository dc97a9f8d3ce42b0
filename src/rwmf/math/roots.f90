!> Root and maximum searches in one dimension by reverse communication.
!>
!> A search returns the next point; the caller evaluates the function there and passes the value
!> back. All procedures are therefore pure, and the caller handles the arguments and the failures of
!> the function. Numbers are in the caller's units.
module rwmf_math_roots
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: bracket_t, bracket_between, narrow, is_wider, keep_inside
   public :: secant_t, secant_between, close_in
   public :: maximum_t, maximum_between, climb, vertex_of_parabola
   public :: stationary_point

   !> Interval in which a function passes a level. Bisection:
   !>
   !>    bracket = bracket_between(low, high)
   !>    do while (bracket%is_open)
   !>       call narrow(bracket, is_beyond=f(bracket%middle) > level)
   !>    end do
   !>
   !> Newton's method narrows the bracket at its own points, `narrow(bracket, is_beyond, x)`, and
   !> calls `keep_inside` for the next one.
   type :: bracket_t
      real(wp) :: low, high
      !! ends before and beyond the passage
      real(wp) :: middle
      logical :: is_open
      !! at least one number lies between the ends
   end type bracket_t

   !> Interval at whose ends a function has different signs, for regula falsi. While it is open,
   !> `close_in` takes the value at `next`.
   type :: secant_t
      real(wp) :: x(2)
      !! ends
      real(wp) :: next
      !! next point to evaluate
      logical :: is_open
      !! the distance of the ends exceeds the resolution
      real(wp), private :: f(2), resolution
      !! values at the ends, halved for an end that is kept; resolution: sufficient distance of the
      !! ends
      integer, private :: last = 0, count = 0
      !! end that was replaced last; number of points so far
   end type secant_t

   !> Search for a maximum by Brent's method: while it is open, `climb` takes the value at `next`.
   type :: maximum_t
      real(wp) :: next
      !! next point to evaluate
      real(wp) :: x(3)
      !! the best three points, best first
      logical :: is_open = .true.
      !! x(1) is not yet known to within sqrt(epsilon) times the interval
      real(wp), private :: f(3), low, high, step, before_last
      !! values at x; bracket; the last two steps
      real(wp), private :: smallest
      !! smallest distance between two points
      real(wp), private :: start, near = 0
      !! first point; distance of the next two points from it if they lie close to it
      integer, private :: count = 0
      !! number of points so far
   end type maximum_t

contains

   !> Bracket between two ends, to be narrowed.
   pure type(bracket_t) function bracket_between(low, high) result(bracket)
      real(wp), intent(in) :: low, high

      bracket = bracket_t(low, high, low, .false.)
      call find_middle(bracket)
   end function bracket_between

   !> Replace one end of a bracket by a point inside it.
   pure subroutine narrow(bracket, is_beyond, x)
      type(bracket_t), intent(inout) :: bracket
      logical, intent(in) :: is_beyond
      !! the function has passed the level at the point
      real(wp), intent(in), optional :: x
      !! the point; absent: the middle

      if (present(x)) bracket%middle = x
      if (is_beyond) then
         bracket%high = bracket%middle
      else
         bracket%low = bracket%middle
      end if
      call find_middle(bracket)
   end subroutine narrow

   pure subroutine find_middle(bracket)
      type(bracket_t), intent(inout) :: bracket

      bracket%middle = bracket%low + (bracket%high - bracket%low)/2
      bracket%is_open = bracket%middle > bracket%low .and. bracket%middle < bracket%high
   end subroutine find_middle

   !> True if the ends of an open bracket are more than the given number of spacings apart.
   pure logical function is_wider(bracket, spacings)
      type(bracket_t), intent(in) :: bracket
      integer, intent(in) :: spacings
      !! in units of the spacing of numbers at `high`

      is_wider = bracket%is_open
      ! This bound is at least one spacing and saves two calls.
      if (.not. bracket%high - bracket%low > spacings*max(epsilon(1.0_wp)*abs(bracket%high), &
          tiny(1.0_wp))) is_wider = is_wider .and. bracket%high - bracket%low &
         > spacings*spacing(bracket%high)
   end function is_wider

   !> Point `x` if it lies inside the bracket, otherwise the middle.
   pure real(wp) function keep_inside(bracket, x, may_be_end) result(inside)
      type(bracket_t), intent(in) :: bracket
      real(wp), intent(in) :: x
      !! next point proposed by Newton's method
      logical, intent(in), optional :: may_be_end
      !! accept a point on an end; absent: reject it

      inside = bracket%middle
      if (x > bracket%low .and. x < bracket%high) inside = x
      if (.not. present(may_be_end)) return
      if (may_be_end .and. x >= bracket%low .and. x <= bracket%high) inside = x
   end function keep_inside

   !> Interval for regula falsi with its first point.
   pure type(secant_t) function secant_between(x, f, resolution) result(secant)
      real(wp), intent(in) :: x(2), f(2)
      !! ends, and function values of different sign there
      real(wp), intent(in), optional :: resolution
      !! sufficient distance of the ends, if larger than two spacings of the numbers

      secant%x = x
      secant%f = f
      secant%resolution = 0
      if (present(resolution)) secant%resolution = resolution
      call find_next(secant)
   end function secant_between

   !> Replace an end of the interval by the evaluated point. If the other end is kept for the second
   !> time, its value is halved (Illinois method), so that both ends converge.
   pure subroutine close_in(secant, value)
      type(secant_t), intent(inout) :: secant
      real(wp), intent(in) :: value
      !! of the function at `next`
      integer :: k

      k = merge(1, 2, value*sign(1.0_wp, secant%f(1)) > 0)
      secant%x(k) = secant%next
      secant%f(k) = value
      if (k == secant%last) secant%f(3 - k) = secant%f(3 - k)/2
      secant%last = k
      call find_next(secant)
   end subroutine close_in

   !> Find the next point: the zero of the secant, at least half the resolution or one spacing away
   !> from the ends.
   !>
   !> The margin encloses a root that is approached from one side only. The middle of the interval
   !> is used if the secant gives no point inside, and at every eighth point.
   pure subroutine find_next(secant)
      type(secant_t), intent(inout) :: secant
      real(wp) :: width
      real(wp) :: x
      !! zero of the secant

      width = secant%x(2) - secant%x(1)
      secant%count = secant%count + 1
      secant%is_open = width > max(secant%resolution, 2*spacing(secant%x(2)))
      secant%next = secant%x(1) + width/2
      if (mod(secant%count, 8) == 0 .or. abs(secant%f(1) - secant%f(2)) <= 0) return
      associate (f => secant%f, margin => max(secant%resolution/2, spacing(secant%x(2))))
         x = secant%x(1) + min(max(width*(f(1)/(f(1) - f(2))), margin), width - margin)
      end associate
      if (x > secant%x(1) .and. x < secant%x(2)) secant%next = x
   end subroutine find_next

   !> Search for a maximum with its first point.
   pure type(maximum_t) function maximum_between(low, high, start, is_near) result(search)
      real(wp), intent(in) :: low, high
      real(wp), intent(in) :: start
      !! inside
      logical, intent(in), optional :: is_near
      !! `start` is near a maximum of a smooth function. The search first evaluates points close to
      !! it, and ends when the parabola through the best points promises a gain below round-off.
      real(wp), parameter :: part = 1.0_wp/256

      search%low = low
      search%high = high
      search%smallest = max(sqrt(epsilon(low))*(high - low), 4*spacing(high))
      search%next = start
      search%step = high - low
      search%before_last = search%step
      search%start = start
      if (.not. present(is_near)) return
      if (is_near) search%near = min(part*search%step, (start - low)/2, (high - start)/2)
   end function maximum_between

   !> Take the value at the evaluated point and choose the next one.
   !>
   !> The next point is the vertex of the parabola through the best three points, or a golden
   !> section if that fails. No value may exceed `huge`.
   pure subroutine climb(search, value)
      type(maximum_t), intent(inout) :: search
      real(wp), intent(in) :: value
      !! of the function at `next`
      integer, parameter :: most_points = 60
      real(wp), parameter :: golden = (3 - sqrt(5.0_wp))/2

      search%count = search%count + 1
      if (search%count == 1) then
         search%x = search%next
         search%f = value
      else
         call rank(search, value)
      end if
      associate (best => search%x(1), low => search%low, high => search%high, &
         smallest => search%smallest, next => search%next)
         search%is_open = max(best - low, high - best) > 2*smallest &
            .and. value < huge(value) .and. search%count < most_points
         if (search%near > 0 .and. search%count < 3) then
            next = search%start + merge(search%near, -search%near, search%count == 1)
            return
         end if
         next = vertex_of_parabola(search%x, search%f)
         if (search%near > 0) search%is_open = search%is_open .and. promises_more(search)
         if (.not. (next > low + smallest .and. next < high - smallest &
             .and. abs(next - best) < search%before_last/2)) then
            next = best + golden*(merge(low, high, best > (low + high)/2) - best)
         end if
         search%before_last = search%step
         search%step = abs(next - best)
         if (search%step < smallest) next = best + sign(smallest, merge(low, high, best - low > &
            high - best) - best)
      end associate
   end subroutine climb

   !> True if the parabola through the best three points rises above the best of them by more than
   !> round-off.
   pure logical function promises_more(search)
      type(maximum_t), intent(in) :: search
      !! search whose next point is the vertex of the parabola
      real(wp) :: bend

      promises_more = .true.
      if (.not. (search%next > search%low .and. search%next < search%high)) return
      associate (x => search%x, f => search%f)
         bend = ((f(3) - f(1))/(x(3) - x(1)) - (f(2) - f(1))/(x(2) - x(1)))/(x(3) - x(2))
         promises_more = .not. (bend <= 0 .and. -bend*(search%next - x(1))**2 <= 4*epsilon(bend) &
            *abs(f(1)))
      end associate
   end function promises_more

   !> Insert a new point into the best three by rank, and tighten the bracket.
   pure subroutine rank(search, value)
      type(maximum_t), intent(inout) :: search
      real(wp), intent(in) :: value

      associate (x => search%x, f => search%f, new => search%next)
         if (value >= f(1) .neqv. new > x(1)) then
            search%high = max(new, x(1))
         else
            search%low = min(new, x(1))
         end if
         if (value >= f(1)) then
            x = [new, x(:2)]
            f = [value, f(:2)]
         else if (value >= f(2) .or. abs(x(2) - x(1)) <= 0) then
            x = [x(1), new, x(2)]
            f = [f(1), value, f(2)]
         else if (value >= f(3) .or. abs(x(3) - x(1)) <= 0 .or. abs(x(3) - x(2)) <= 0) then
            x(3) = new
            f(3) = value
         end if
      end associate
   end subroutine rank

   !> Stationary point of the parabola through three points; `huge` for a straight line.
   pure real(wp) function vertex_of_parabola(x, f) result(vertex)
      real(wp), intent(in) :: x(3), f(3)
      real(wp) :: p, q

      p = (x(2) - x(1))**2*(f(2) - f(3)) - (x(2) - x(3))**2*(f(2) - f(1))
      q = 2*((x(2) - x(1))*(f(2) - f(3)) - (x(2) - x(3))*(f(2) - f(1)))
      vertex = huge(vertex)
      if (abs(p) < abs(q)*sqrt(huge(p))) vertex = x(2) - p/q
   end function vertex_of_parabola

   !> Stationary point of the cubic with values v and slopes s of opposite sign at 0 and 1.
   pure real(wp) function stationary_point(v_0, s_0, v_1, s_1) result(x)
      real(wp), intent(in) :: v_0, s_0, v_1, s_1
      real(wp) :: a, b, root

      ! Slope of the cubic: a x**2 + 2 b x + s_0.
      a = 3*(s_0 + s_1 - 2*(v_1 - v_0))
      b = 3*(v_1 - v_0) - 2*s_0 - s_1
      root = sqrt(max(0.0_wp, b**2 - a*s_0))
      ! The slopes differ in sign, so exactly one root lies inside; this form never cancels there.
      x = s_0/(-b + sign(root, s_0))
      if (.not. (x >= 0 .and. x <= 1)) x = s_0/(s_0 - s_1)
   end function stationary_point

end module rwmf_math_roots
