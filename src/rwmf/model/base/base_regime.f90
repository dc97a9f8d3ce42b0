!> Regimes of a wall on a base that gives: functions that end each of them, and the change that
!> follows.
!>
!> A function is positive throughout its regime. Functions that vanish at the start of a step,
!> because their root has just been passed, are divided by the time, so that this root is not found
!> again.
module rwmf_model_base_base_regime
   use rwmf_core_kinds, only: wp
   use rwmf_math_polynomial_roots, only: first_negative
   use rwmf_math_power_series, only: product_term, series_value
   use rwmf_model_base_base_scene, only: base_scene_t, loaded_springs
   use rwmf_model_base_base_series, only: at_edge, at_first, at_second, base_mode_t, &
      base_series_t, expand, is_crushing, is_off, is_pressed, is_settled, set_state
   use rwmf_model_hysteresis_spring_laws, only: loading_direction, pass_limit, spring_limits, &
      turn_spring
   use rwmf_model_series_series_motion, only: highest_order
   implicit none
   private

   public :: base_regime_t, begin_regime, collect_functions, find_event, change_regime
   public :: base_function_t, of_overturning

   integer, parameter :: of_cross = 5
   !! 1 to 4: both conditions of contact, at the left and the right edge of the base
   integer, parameter :: of_tendon = 6
   integer, parameter :: of_stick = 7
   !! and 8: H reaches mu N, -mu N
   integer, parameter :: of_slip = 9
   integer, parameter :: of_overturning = 10
   !! and 11: theta reaches the overturning angle on the right and on the left
   integer, parameter :: before_strips = 11
   !! three functions for each strip follow: its settlement, its stress, its limit; then three for
   !! each spring: upper and lower limit of its elongation, and its rate

   !> Regime of the motion and the functions whose roots have just been passed.
   type, extends(base_mode_t) :: base_regime_t
      logical :: is_met(of_cross) = .true.
      !! the conditions of contact hold at the edges, and the first root is right of the second
      logical, allocatable :: passed(:)
      !! (functions) the root lies at the present time
      integer :: slips = 0
      !! number of slips that began or reversed
      integer :: flights = 0
      !! number of times that the wall has left its base
      real(wp) :: t_flight = -1
      !! first of these times; negative: none [s]
   end type base_regime_t

   !> Function that ends a regime when it falls below zero.
   type :: base_function_t
      integer :: number = 0
      real(wp) :: c(0:highest_order) = 0
      !! coefficients in powers of s, in the unit of the function
   end type base_function_t

contains

   !> Enter the regime of a state.
   pure subroutine begin_regime(scene, y, regime)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states) as of `set_state`
      type(base_regime_t), intent(out) :: regime
      real(wp) :: a(2), b(2), span(2)

      call find_lines(scene, y, a, b)
      regime%is_met(1:3:2) = -scene%b*a - b >= 0
      regime%is_met(2:4:2) = scene%b*a - b >= 0
      regime%is_met(of_cross) = b(1)*a(2) - b(2)*a(1) > 0
      allocate (regime%passed(before_strips + 3*(scene%strips + size(scene%springs))), &
         source=.false.)
      regime%springs = loaded_springs(scene, y)
      call find_contact(scene, regime)
      if (scene%slides .and. abs(y(4)) > 0) regime%slip = int(sign(1.0_wp, y(4)))
      span = [y(3) + 2*scene%h*a(1), y(5) + 2*scene%h*cos(y(1))]
      if (scene%has_tendon) regime%is_taut = scene%eta_0 + scene%eta_slope*(norm2(span) &
         - scene%l_0) >= 0
      regime%depth = max(0.0_wp, scene%place*a(1) - y(5) - scene%d_y)
      regime%strips = merge(is_pressed, is_off, scene%place*a(1) - y(5) >= 0)
   end subroutine begin_regime

   !> Find settlement and damped stress over k at a place xi, both a xi - b, in a state.
   pure subroutine find_lines(scene, y, a, b)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: a(2), b(2)
      !! [-], [m]

      a = [sin(y(1)), sin(y(1)) + scene%delay*cos(y(1))*y(2)]
      b = [y(5), y(5) + scene%delay*y(6)]
   end subroutine find_lines

   !> Find the ends of the contact from the conditions at the edges.
   pure subroutine find_contact(scene, regime)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(inout) :: regime
      logical :: partial(2), rises(2)

      if (.not. scene%delay > 0) regime%is_met(3:4) = regime%is_met(1:2)
      associate (left => regime%is_met(1:3:2), right => regime%is_met(2:4:2), &
                 cross => regime%is_met(of_cross))
         regime%touches = all(left .or. right)
         regime%left = at_edge
         regime%right = at_edge
         partial = left .neqv. right
         rises = right
         if (all(partial) .and. (rises(1) .eqv. rises(2))) then
            ! the root that comes later from the free edge bounds the contact
            if (rises(1)) regime%left = merge(at_first, at_second, cross)
            if (.not. rises(1)) regime%right = merge(at_second, at_first, cross)
         else
            if (partial(1) .and. rises(1)) regime%left = at_first
            if (partial(1) .and. .not. rises(1)) regime%right = at_first
            if (partial(2) .and. rises(2)) regime%left = at_second
            if (partial(2) .and. .not. rises(2)) regime%right = at_second
            if (all(partial)) regime%touches = rises(1) .eqv. cross
         end if
      end associate
   end subroutine find_contact

   !> Collect the functions that can end the regime, from the series of a step.
   subroutine collect_functions(scene, regime, overturning, series, functions, n)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: overturning
      !! rotation at which the wall counts as overturned [rad]
      type(base_series_t), intent(in) :: series
      type(base_function_t), intent(inout) :: functions(:)
      !! at least `size(regime%passed)`
      integer, intent(out) :: n
      !! number of functions
      real(wp), parameter :: spacings = 16
      !! round-off of a sum of products [-]
      real(wp) :: c(0:highest_order), sizes(0:highest_order, 4), noise
      integer :: k, order

      n = 0
      order = series%order
      associate (of => series, b => scene%b)
         if (scene%strips > 0) then
            do k = 1, scene%strips
               call add_strip(k)
            end do
         else
            call add(1, -b*of%turn%sine - of%z)
            call add(2, b*of%turn%sine - of%z)
            if (scene%delay > 0) then
               call add(3, -b*of%contact%a2 - of%contact%b2)
               call add(4, b*of%contact%a2 - of%contact%b2)
               if ((regime%is_met(1) .neqv. regime%is_met(2)) .and. (regime%is_met(3) .neqv. &
                   regime%is_met(4))) then
                  sizes(:order, 1) = abs(of%z(:order))
                  sizes(:order, 2) = abs(of%contact%a2(:order))
                  sizes(:order, 3) = abs(of%contact%b2(:order))
                  sizes(:order, 4) = abs(of%turn%sine(:order))
                  do k = 0, order
                     c(k) = product_term(k, of%z, of%contact%a2) - product_term(k, &
                        of%contact%b2, of%turn%sine)
                     ! both conditions are the same for a wall that stands or slides without rocking
                     noise = product_term(k, sizes(:, 1), sizes(:, 2)) &
                        + product_term(k, sizes(:, 3), sizes(:, 4))
                     if (abs(c(k)) <= spacings*epsilon(noise)*noise) c(k) = 0
                  end do
                  call add(of_cross, c)
               end if
            end if
         end if
         do k = 1, size(scene%springs)
            call add_spring(k)
         end do
         if (scene%has_tendon) call add(of_tendon, merge(1, -1, regime%is_taut)*of%tendon)
         if (scene%slides) then
            if (regime%slip == 0) then
               call add(of_stick, scene%mu*of%normal - of%shear)
               call add(of_stick + 1, scene%mu*of%normal + of%shear)
            else
               call add(of_slip, regime%slip*of%x_dot)
            end if
         end if
         c = -of%theta
         c(0) = overturning - of%theta(0)
         call add(of_overturning, c)
         c = of%theta
         c(0) = overturning + of%theta(0)
         call add(of_overturning + 1, c)
      end associate

   contains

      subroutine add(number, series_of)
         integer, intent(in) :: number
         real(wp), intent(in) :: series_of(0:highest_order)

         n = n + 1
         functions(n)%number = number
         functions(n)%c(:order) = series_of(:order)
         if (number <= of_cross) then
            if (.not. regime%is_met(number)) functions(n)%c(:order) = -series_of(:order)
         end if
         if (regime%passed(number)) functions(n)%c(0) = 0
      end subroutine add

      !> Add the functions that end the branch of a strip.
      subroutine add_strip(i)
         integer, intent(in) :: i
         real(wp) :: deep(0:highest_order), rate(0:highest_order)
         integer :: first

         associate (of => series, xi => scene%place(i))
            first = before_strips + 3*i - 2
            rate(:order) = of%turn%cosine_rate(:order)*xi - of%z_dot(:order)
            deep(:order) = of%turn%sine(:order)*xi - of%z(:order)
            deep(0) = deep(0) - regime%depth(i)
            select case (regime%strips(i))
            case (is_off)
               call add(first, -deep)
            case (is_pressed)
               call add(first, deep)
               if (scene%delay > 0) call add(first + 1, deep + scene%delay*rate)
               deep = -deep
               deep(0) = deep(0) + scene%d_y
               call add(first + 2, deep)
            case (is_settled)
               call add(first, deep)
               call add(first + 1, -(deep + scene%delay*rate))
            case default
               call add(first + 1, rate)
            end select
         end associate
      end subroutine add_strip

      !> Add the functions that end the branch of a spring.
      subroutine add_spring(i)
         integer, intent(in) :: i
         real(wp) :: room(0:highest_order), low, high
         integer :: first, direction

         first = before_strips + 3*(scene%strips + i) - 2
         call spring_limits(scene%springs(i), regime%springs(i), low, high)
         room(:order) = series%device%stretch(:order, i)
         room(0) = room(0) - low
         if (low > -huge(low)) call add(first + 1, room)
         room(:order) = -series%device%stretch(:order, i)
         room(0) = high + room(0)
         if (high < huge(high)) call add(first, room)
         direction = loading_direction(scene%springs(i), regime%springs(i))
         if (direction /= 0) call add(first + 2, direction*series%device%stretch_dot(:, i))
      end subroutine add_spring
   end subroutine collect_functions

   !> Find the first function that falls below zero within a step.
   pure subroutine find_event(functions, order, h, event, t)
      type(base_function_t), intent(in) :: functions(:)
      integer, intent(in) :: order
      !! of the series
      real(wp), intent(in) :: h
      !! length of the step [s]
      integer, intent(out) :: event
      !! place of the function; 0 if none does
      real(wp), intent(out) :: t
      !! time since the start of the step; h without an event [s]
      real(wp), parameter :: negligible = 1.0e-4_wp
      !! error of the first coefficient of a function that starts at zero, over the later ones [-]
      real(wp) :: c(0:highest_order), sum_of_terms, root
      integer :: i, k, n

      event = 0
      t = h
      do i = 1, size(functions)
         n = order
         c(:n) = functions(i)%c(:n)
         do while (.not. abs(c(0)) > 0 .and. n > 1)
            c(:n - 1) = c(1:n)
            n = n - 1
            sum_of_terms = 0
            do k = n, 1, -1
               sum_of_terms = (sum_of_terms + abs(c(k)))*h
            end do
            ! a slip that begins where H reaches its limit has no acceleration yet
            if (c(0) < 0 .and. (-c(0) <= negligible*sum_of_terms .or. functions(i)%number &
                == of_slip)) c(0) = 0
         end do
         if (n > 1) then
            sum_of_terms = 0
            do k = n, 1, -1
               sum_of_terms = (sum_of_terms + abs(c(k)))*t
            end do
            if (c(0) > sum_of_terms) cycle
         end if
         root = first_negative(c(:n), t)
         if (root > t) cycle
         event = i
         t = root
      end do
   end subroutine find_event

   !> Enter the regime behind an event.
   subroutine change_regime(scene, number, t, span, y, series, regime)
      type(base_scene_t), intent(in) :: scene
      integer, intent(in) :: number
      !! number of the function that has fallen below zero
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: span
      !! time since the start of the step [s]
      real(wp), intent(inout) :: y(:)
      !! (states) at the event
      type(base_series_t), intent(inout) :: series
      !! that of the step; on return without meaning
      type(base_regime_t), intent(inout) :: regime
      real(wp) :: a(2), b(2)
      logical :: touched

      regime%passed(number) = .true.
      if (number <= of_cross) then
         touched = regime%touches
         regime%is_met(number) = .not. regime%is_met(number)
         ! the order of the roots is followed only while both lie under the wall
         call find_lines(scene, y, a, b)
         if (number < of_cross) regime%is_met(of_cross) = b(1)*a(2) - b(2)*a(1) > 0
         call find_contact(scene, regime)
         call note_contact(touched)
      else if (number == of_tendon) then
         regime%is_taut = .not. regime%is_taut
      else if (number == of_stick .or. number == of_stick + 1) then
         regime%slip = merge(-1, 1, number == of_stick)
         regime%passed(of_slip) = .true.
         regime%slips = regime%slips + 1
      else if (number == of_slip) then
         call stop_slip
      else if (number > before_strips + 3*scene%strips) then
         call change_spring((number - before_strips + 2)/3 - scene%strips)
      else if (number > before_strips) then
         touched = any(regime%strips == is_pressed .or. regime%strips == is_crushing)
         call change_strip((number - before_strips + 2)/3)
         regime%touches = any(regime%strips == is_pressed .or. regime%strips == is_crushing)
         call note_contact(touched)
      end if

   contains

      !> Count a flight.
      subroutine note_contact(touched)
         logical, intent(in) :: touched

         if (.not. touched .or. regime%touches) return
         regime%flights = regime%flights + 1
         if (regime%t_flight < 0) regime%t_flight = t
      end subroutine note_contact

      !> Stick where the friction holds the base, or slip the other way.
      subroutine stop_slip
         real(wp) :: ground(0:highest_order), upward(0:highest_order)

         ground = 0
         upward = 0
         y(4) = 0
         if (.not. regime%touches) then
            regime%slip = -regime%slip
            regime%slips = regime%slips + 1
            return
         end if
         regime%slip = 0
         ground(0) = series_value(series%ground(:series%order), span)
         upward(0) = series_value(series%upward(:series%order), span)
         call set_state(y, ground, upward, series)
         call expand(scene, regime%base_mode_t, 0, series)
         if (abs(series%shear(0)) <= scene%mu*series%normal(0)) return
         regime%slip = -int(sign(1.0_wp, series%shear(0)))
         regime%slips = regime%slips + 1
      end subroutine stop_slip

      !> Change the branch of a strip.
      subroutine change_strip(i)
         integer, intent(in) :: i
         real(wp) :: rate

         rate = scene%place(i)*cos(y(1))*y(2) - y(6)
         select case (number - before_strips - 3*(i - 1))
         case (1)
            regime%strips(i) = merge(is_off, merge(is_pressed, is_settled, rate >= 0), &
               regime%strips(i) /= is_off)
         case (2)
            if (regime%strips(i) == is_crushing) then
               regime%depth(i) = scene%place(i)*sin(y(1)) - y(5) - scene%d_y
               regime%strips(i) = is_pressed
               regime%passed(number:number + 1) = [.false., .true.]
            else
               regime%strips(i) = merge(is_settled, is_pressed, regime%strips(i) == is_pressed)
            end if
         case default
            regime%strips(i) = is_crushing
         end select
      end subroutine change_strip

      !> Change the branch of a spring, whose new limit may lie at the present elongation.
      subroutine change_spring(i)
         integer, intent(in) :: i
         integer :: first
         logical :: is_rising

         first = before_strips + 3*(scene%strips + i) - 2
         associate (spring => scene%springs(i), branch => regime%springs(i))
            is_rising = number == first
            if (number == first + 2) then
               is_rising = loading_direction(spring, branch) < 0
               call turn_spring(spring, branch, &
                  series_value(series%device%stretch(:series%order, i), span))
            else
               call pass_limit(spring, branch, is_rising)
            end if
            regime%passed(first:first + 1) = [.not. is_rising, is_rising]
         end associate
      end subroutine change_spring
   end subroutine change_regime

end module rwmf_model_base_base_regime
