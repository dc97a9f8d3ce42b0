!> Searches in one dimension by reverse communication: a search says where it wants to know the
!> function, the caller evaluates it there and hands the value back. So all procedures are pure, and
!> what a function needs, and how it fails, is the caller's affair. Numbers are in the caller's
!> units.
module rwmf_math_roots
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: bracket_t, bracket_between, narrow, is_wider, keep_inside
   public :: secant_t, secant_between, close_in
   public :: maximum_t, maximum_between, climb, vertex_of_parabola
   public :: stationary_point

   !> An interval in which a function passes a level. Bisection:
   !>
   !>    bracket = bracket_between(low, high)
   !>    do while (bracket%is_open)
   !>       call narrow(bracket, is_beyond=f(bracket%middle) > level)
   !>    end do
   !>
   !> Newton's method narrows it at its own points, `narrow(bracket, is_beyond, x)`, and asks
   !> `keep_inside` for the next one.
   type :: bracket_t
      real(wp) :: low, high
      !! before the passage and beyond it
      real(wp) :: middle
      logical :: is_open
      !! numbers lie between the ends
   end type bracket_t

   !> An interval at whose ends a function has different signs, for regula falsi: while it is open,
   !> `close_in` takes the value at `next`.
   type :: secant_t
      real(wp) :: x(2)
      !! ends
      real(wp) :: next
      !! where the function is wanted
      logical :: is_open
      !! the ends are farther apart than wanted
      real(wp), private :: f(2), resolution
      !! values at the ends, of which one that stays counts half; distance of the ends that suffices
      integer, private :: last = 0, count = 0
      !! end that was replaced last, number of points so far
   end type secant_t

   !> Search for a maximum by Brent's method: while it is open, `climb` takes the value at `next`.
   type :: maximum_t
      real(wp) :: next
      !! where the function is wanted
      real(wp) :: x(3)
      !! the best three points, best first
      logical :: is_open = .true.
      !! x(1) is not yet known to a part sqrt(epsilon) of the interval
      real(wp), private :: f(3), low, high, step, before_last
      !! values at x; bracket; the last two steps
      real(wp), private :: smallest
      !! distance that matters
      real(wp), private :: start, near = 0
      !! first point, and the distance of the next two from it where they lie beside it
      integer, private :: count = 0
      !! of the points so far
   end type maximum_t

contains

   !> Begin to narrow an interval.
   pure type(bracket_t) function bracket_between(low, high) result(bracket)
      real(wp), intent(in) :: low, high

      bracket = bracket_t(low, high, low, .false.)
      call find_middle(bracket)
   end function bracket_between

   !> A point inside a bracket becomes one of its ends.
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

   !> Are the ends, which need not become neighbours, still more than so many spacings apart?
   pure logical function is_wider(bracket, spacings)
      type(bracket_t), intent(in) :: bracket
      integer, intent(in) :: spacings
      !! of the numbers at `high`

      is_wider = bracket%is_open
      ! a spacing is at most that, and costs two calls
      if (.not. bracket%high - bracket%low > spacings*max(epsilon(1.0_wp)*abs(bracket%high), &
          tiny(1.0_wp))) is_wider = is_wider .and. bracket%high - bracket%low &
         > spacings*spacing(bracket%high)
   end function is_wider

   !> The point itself where it lies inside a bracket, else the middle.
   pure real(wp) function keep_inside(bracket, x, may_be_end) result(inside)
      type(bracket_t), intent(in) :: bracket
      real(wp), intent(in) :: x
      !! wanted next, by Newton's method
      logical, intent(in), optional :: may_be_end
      !! a point on an end is inside; absent: it is not

      inside = bracket%middle
      if (x > bracket%low .and. x < bracket%high) inside = x
      if (.not. present(may_be_end)) return
      if (may_be_end .and. x >= bracket%low .and. x <= bracket%high) inside = x
   end function keep_inside

   !> Begin with regula falsi.
   pure type(secant_t) function secant_between(x, f, resolution) result(secant)
      real(wp), intent(in) :: x(2), f(2)
      !! ends, and values of different sign there
      real(wp), intent(in), optional :: resolution
      !! distance of the ends that suffices, where it is more than two spacings of the numbers

      secant%x = x
      secant%f = f
      secant%resolution = 0
      if (present(resolution)) secant%resolution = resolution
      call find_next(secant)
   end function secant_between

   !> The point that was wanted becomes an end of the interval. The other end, when it stays for the
   !> second time, counts half (Illinois), so that both close in.
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

   !> Where the secant is zero, half the resolution or a spacing away from the ends at least, so
   !> that a root that is known from one side is enclosed; the middle where that is no place inside,
   !> and every eighth time.
   pure subroutine find_next(secant)
      type(secant_t), intent(inout) :: secant
      real(wp) :: width
      real(wp) :: x
      !! where the secant is zero

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

   !> Begin to search for a maximum.
   pure type(maximum_t) function maximum_between(low, high, start, is_near) result(search)
      real(wp), intent(in) :: low, high
      real(wp), intent(in) :: start
      !! inside
      logical, intent(in), optional :: is_near
      !! it is near a maximum of a smooth function: points beside it say where that is, and the
      !! search ends when the parabola through them promises nothing but round-off
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

   !> Take the value at the point that was wanted and want the next one: by the parabola through the
   !> best three, by a golden section where that fails. Nothing is above `huge`.
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

   !> Does the parabola through the best three points rise above the best of them by more than
   !> round-off?
   pure logical function promises_more(search)
      type(maximum_t), intent(in) :: search
      !! whose next point is its vertex
      real(wp) :: bend

      promises_more = .true.
      if (.not. (search%next > search%low .and. search%next < search%high)) return
      associate (x => search%x, f => search%f)
         bend = ((f(3) - f(1))/(x(3) - x(1)) - (f(2) - f(1))/(x(2) - x(1)))/(x(3) - x(2))
         promises_more = .not. (bend <= 0 .and. -bend*(search%next - x(1))**2 <= 4*epsilon(bend) &
            *abs(f(1)))
      end associate
   end function promises_more

   !> Let a new point take its rank among the best three, and tighten the bracket.
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

   !> Where the parabola through three points is stationary; `huge` for a straight line.
   pure real(wp) function vertex_of_parabola(x, f) result(vertex)
      real(wp), intent(in) :: x(3), f(3)
      real(wp) :: p, q

      p = (x(2) - x(1))**2*(f(2) - f(3)) - (x(2) - x(3))**2*(f(2) - f(1))
      q = 2*((x(2) - x(1))*(f(2) - f(3)) - (x(2) - x(3))*(f(2) - f(1)))
      vertex = huge(vertex)
      if (abs(p) < abs(q)*sqrt(huge(p))) vertex = x(2) - p/q
   end function vertex_of_parabola

   !> Where the cubic with values v and slopes s at 0 and 1 (slopes of opposite sign) is stationary.
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
