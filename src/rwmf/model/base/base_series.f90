!> Taylor series of a wall on a base that gives, in the time since the start of a step.
!>
!> docs/theory/base.md derives the equations. Round n computes coefficient n of everything from
!> coefficients 0 to n of the states, and then coefficient n + 1 of the states.
module rwmf_model_base_base_series
   use rwmf_core_kinds, only: wp
   use rwmf_math_power_series, only: product_term, quotient_term, root_term
   use rwmf_model_base_base_scene, only: base_scene_t
   use rwmf_model_elements, only: line_of_element
   use rwmf_model_series_series_motion, only: highest_order
   use rwmf_model_spring, only: branch_t
   implicit none
   private

   public :: base_series_t, base_mode_t, create_series, set_state, expand, state_count
   public :: is_off, is_pressed, is_crushing, is_settled
   public :: at_edge, at_first, at_second

   integer, parameter :: at_edge = 0
   !! contact ends at an edge of the base
   integer, parameter :: at_first = 1
   !! contact ends where the strip is not pressed in
   integer, parameter :: at_second = 2
   !! contact ends where its damped stress vanishes

   integer, parameter :: is_off = 0
   !! the strip hangs above its crushed base
   integer, parameter :: is_pressed = 1
   !! it carries an elastic stress
   integer, parameter :: is_crushing = 2
   !! it yields
   integer, parameter :: is_settled = 3
   !! it is pressed in, but rises faster than its base

   !> Regime of the motion: branch of every law between two events.
   type :: base_mode_t
      logical :: touches = .true.
      !! the base is in contact
      integer :: left = at_edge, right = at_edge
      !! ends of the contact
      logical :: is_taut = .true.
      !! the tendon carries a force
      integer :: slip = 0
      !! sign of the slip velocity; 0 if the base sticks
      integer, allocatable :: strips(:)
      !! (strips) branch of each, one of `is_off` to `is_settled`
      real(wp), allocatable :: depth(:)
      !! (strips) crushed depth of each [m]
      type(branch_t), allocatable :: springs(:)
      !! (springs) active branch of each
   end type base_mode_t

   !> Series that follow from the rotation.
   type :: turn_series_t
      real(wp), dimension(0:highest_order) :: sine, cosine
      !! of theta [-]
      real(wp), dimension(0:highest_order) :: sine_rate, cosine_rate
      !! sin(theta) theta', cos(theta) theta' [1/s]
      real(wp), dimension(0:highest_order) :: gain, bias
      !! J = du_r/dtheta [m], and u_r'' for theta'' = 0 [m/s2]
      real(wp), dimension(0:highest_order) :: lever, inertia
      !! coefficients of theta'' in the rows of x [m] and theta [m2]
   end type turn_series_t

   !> Series of an elastic strip in contact.
   type :: contact_series_t
      real(wp), dimension(0:highest_order) :: a2, b2
      !! damped stress at xi over k: a2 xi - b2 [-], [m]
      real(wp) :: ends(0:highest_order, 3, 2)
      !! first to third powers of the left and the right end of the contact [m], [m2], [m3]
      real(wp) :: spans(0:highest_order, 3)
      !! differences of these powers
   end type contact_series_t

   !> Series of the tendon.
   type :: tendon_series_t
      real(wp), dimension(0:highest_order) :: span_x, span_z, length
      !! distances of its anchors [m]
      real(wp), dimension(0:highest_order) :: arm
      !! arm of its force about the middle of the base, times its length [m2]
      real(wp), dimension(0:highest_order) :: pull
      !! its force over m_w and its length [1/s2]
   end type tendon_series_t

   !> Series of the devices under the base. The stroke of each is rise - 2 offset sine.
   type :: device_series_t
      real(wp), dimension(0:highest_order) :: sine, cosine
      !! of theta/2 [-]
      real(wp), dimension(0:highest_order) :: sine_rate, cosine_rate
      !! cos(theta/2) theta'/2, sin(theta/2) theta'/2 [1/s]
      real(wp), dimension(0:highest_order) :: lift
      !! height of the middle of the base over its place at rest [m]
      real(wp), dimension(0:highest_order) :: rise, rise_dot
      !! stroke of a device in the middle of the base [m] and its rate [m/s]
      real(wp), dimension(0:highest_order) :: arm
      !! derivative of that stroke by theta [m]
      real(wp), dimension(0:highest_order) :: force, couple
      !! sums of the forces over m_w [m/s2] and of their products with the offsets [m2/s2]
      real(wp), allocatable :: stretch(:, :), stretch_dot(:, :)
      !! (0:highest_order, springs) elongation of each [m] and its rate [m/s]
   end type device_series_t

   !> Ground acceleration, weight and forces of the frame on the top of the wall.
   type :: load_series_t
      real(wp), dimension(0:highest_order) :: weight
      !! over m_w [m/s2]
      real(wp), dimension(0:highest_order) :: roof
      !! force of frame and ground on u_r over m_w, for theta'' = 0 [m/s2]
   end type load_series_t

   !> Series of one step. Index n is the coefficient of the n-th power, in the unit of the quantity
   !> over s**n.
   type :: base_series_t
      integer :: order = -1
      !! highest coefficient of everything but the states, which have one more
      integer, private :: degree = 0
      !! of the ground's motion: no later coefficient differs from zero
      real(wp), dimension(0:highest_order) :: x, z, theta
      !! slip [m], height of the middle of the base [m], rotation [rad]
      real(wp), dimension(0:highest_order) :: x_dot, z_dot, theta_dot
      !! their rates [m/s], [m/s], [rad/s]
      real(wp), dimension(0:highest_order) :: x_ddot, z_ddot, theta_ddot
      !! their accelerations [m/s2], [m/s2], [rad/s2]
      real(wp), allocatable :: q(:, :), q_dot(:, :), q_ddot(:, :)
      !! (0:highest_order, free floors) displacements [m] and their derivatives
      real(wp), dimension(0:highest_order) :: ground, upward
      !! ground acceleration, horizontal and vertical [m/s2]
      real(wp), dimension(0:highest_order) :: u, u_dot, u_ddot
      !! displacement u_r of the wall's top over its base [m] and its derivatives
      real(wp), dimension(0:highest_order) :: normal, moment, shear
      !! forces of the base over m_w: N, H [m/s2], and the moment of N about the middle [m2/s2]
      real(wp), dimension(0:highest_order) :: tendon
      !! force of the tendon over m_w g [-]
      real(wp), dimension(0:highest_order) :: anchor
      !! horizontal force of tendon and devices on the ground over m_w [m/s2]
      real(wp), allocatable :: force(:, :)
      !! (0:highest_order, 2 + free) forces of the frame on w [m/s2]
      type(turn_series_t) :: turn
      type(contact_series_t) :: contact
      type(device_series_t) :: device
      type(tendon_series_t), private :: cable
      type(load_series_t), private :: load
   end type base_series_t

contains

   !> Number of states: x, z, theta and their velocities, then those of the free floors.
   pure integer function state_count(scene) result(n)
      type(base_scene_t), intent(in) :: scene

      n = 2*(3 + scene%frame%free)
   end function state_count

   !> Allocate the series of a scene.
   pure subroutine create_series(scene, series)
      type(base_scene_t), intent(in) :: scene
      type(base_series_t), intent(out) :: series

      associate (free => scene%frame%free)
         allocate (series%q(0:highest_order, free), series%q_dot(0:highest_order, free), &
            series%q_ddot(0:highest_order, free))
         allocate (series%force(0:highest_order, 2 + free), source=0.0_wp)
         associate (at => series%device, springs => size(scene%springs))
            allocate (at%stretch(0:highest_order, springs), &
               at%stretch_dot(0:highest_order, springs))
         end associate
      end associate
   end subroutine create_series

   !> Begin the series with the states at the start of the step.
   pure subroutine set_state(y, ground, upward, series)
      real(wp), intent(in) :: y(:)
      !! (states) theta, theta', x, x', z, z', q, q'
      real(wp), intent(in) :: ground(0:highest_order), upward(0:highest_order)
      !! accelerations of the ground [m/s2]
      type(base_series_t), intent(inout) :: series
      integer :: free

      free = size(series%q, 2)
      series%order = -1
      series%theta(0) = y(1)
      series%theta_dot(0) = y(2)
      series%x(0) = y(3)
      series%x_dot(0) = y(4)
      series%z(0) = y(5)
      series%z_dot(0) = y(6)
      series%q(0, :) = y(7:6 + free)
      series%q_dot(0, :) = y(7 + free:)
      series%ground = ground
      series%upward = upward
      series%degree = max(1, findloc(abs(ground) > 0 .or. abs(upward) > 0, .true., 1, &
         back=.true.)) - 1
   end subroutine set_state

   !> Continue the series to an order.
   pure subroutine expand(scene, mode, order, series)
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      integer, intent(in) :: order
      !! highest coefficient on return
      type(base_series_t), intent(inout) :: series
      integer :: n

      do n = series%order + 1, order
         call expand_kinematics(n, scene, series)
         if (scene%strips > 0) then
            call expand_strips(n, scene, mode, series)
         else
            call expand_contact(n, scene, mode, series)
         end if
         if (scene%has_tendon) call expand_tendon(n, scene, mode, series)
         if (size(scene%devices) > 0) call expand_devices(n, scene, mode, series)
         if (scene%frame%n > 0) call expand_frame(n, scene, mode, series)
         call accelerate(n, scene, mode, series)
         if (n < highest_order) call continue_states(n + 1, series)
      end do
      series%order = order
   end subroutine expand

   !> Continue the states from their rates.
   pure subroutine continue_states(n, series)
      integer, intent(in) :: n
      !! number of the next coefficient
      type(base_series_t), intent(inout) :: series

      series%theta(n) = series%theta_dot(n - 1)/n
      series%theta_dot(n) = series%theta_ddot(n - 1)/n
      series%x(n) = series%x_dot(n - 1)/n
      series%x_dot(n) = series%x_ddot(n - 1)/n
      series%z(n) = series%z_dot(n - 1)/n
      series%z_dot(n) = series%z_ddot(n - 1)/n
      series%q(n, :) = series%q_dot(n - 1, :)/n
      series%q_dot(n, :) = series%q_ddot(n - 1, :)/n
   end subroutine continue_states

   pure subroutine expand_kinematics(n, scene, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_series_t), intent(inout) :: series

      associate (of => series, h => scene%h, b => scene%b)
         if (n == 0) then
            of%turn%sine(0) = sin(of%theta(0))
            of%turn%cosine(0) = cos(of%theta(0))
            of%u(0) = 2*h*of%turn%sine(0) + 2*b*sin(of%theta(0)/2)**2
         else
            of%turn%sine(n) = of%turn%cosine_rate(n - 1)/n
            of%turn%cosine(n) = -of%turn%sine_rate(n - 1)/n
            of%u(n) = 2*h*of%turn%sine(n) - b*of%turn%cosine(n)
         end if
         of%turn%sine_rate(n) = product_term(n, of%turn%sine, of%theta_dot)
         of%turn%cosine_rate(n) = product_term(n, of%turn%cosine, of%theta_dot)
         of%turn%gain(n) = 2*h*of%turn%cosine(n) + b*of%turn%sine(n)
         of%u_dot(n) = 2*h*of%turn%cosine_rate(n) + b*of%turn%sine_rate(n)
         of%contact%a2(n) = of%turn%sine(n) + scene%delay*of%turn%cosine_rate(n)
         of%contact%b2(n) = of%z(n) + scene%delay*of%z_dot(n)
      end associate
   end subroutine expand_kinematics

   !> Expand the forces of an elastic strip from the ends of its contact.
   pure subroutine expand_contact(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series

      associate (of => series)
         of%normal(n) = 0
         of%moment(n) = 0
         of%contact%ends(n, :, :) = 0
         of%contact%spans(n, :) = 0
         if (.not. mode%touches) return
         call expand_end(mode%left, -scene%b, of%contact%ends(:, :, 1))
         call expand_end(mode%right, scene%b, of%contact%ends(:, :, 2))
         of%contact%spans(n, :) = of%contact%ends(n, :, 2) - of%contact%ends(n, :, 1)
         of%normal(n) = scene%kappa*(product_term(n, of%contact%a2, of%contact%spans(:, 2))/2 &
            - product_term(n, of%contact%b2, of%contact%spans(:, 1)))
         of%moment(n) = scene%kappa*(product_term(n, of%contact%a2, of%contact%spans(:, 3))/3 &
            - product_term(n, of%contact%b2, of%contact%spans(:, 2))/2)
      end associate

   contains

      !> Coefficient n of an end of the contact and of its powers.
      pure subroutine expand_end(kind, edge, powers)
         integer, intent(in) :: kind
         real(wp), intent(in) :: edge
         !! [m]
         real(wp), intent(inout) :: powers(0:highest_order, 3)
         !! [m], [m2], [m3]

         select case (kind)
         case (at_first)
            powers(n, 1) = quotient_term(n, series%z(n), series%turn%sine, powers(:, 1))
         case (at_second)
            powers(n, 1) = quotient_term(n, series%contact%b2(n), series%contact%a2, powers(:, 1))
         case default
            if (n == 0) powers(0, :) = [edge, edge**2, edge**3]
            return
         end select
         powers(n, 2) = product_term(n, powers(:, 1), powers(:, 1))
         powers(n, 3) = product_term(n, powers(:, 2), powers(:, 1))
      end subroutine expand_end
   end subroutine expand_contact

   !> Add up the forces of strips on their branches.
   pure subroutine expand_strips(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series
      real(wp) :: flow(2), stress
      integer :: i

      associate (of => series)
         ! rate of the settlement: flow(1) xi - flow(2)
         flow = scene%delay*[of%turn%cosine_rate(n), of%z_dot(n)]
         of%normal(n) = 0
         of%moment(n) = 0
         do i = 1, scene%strips
            associate (xi => scene%place(i))
               select case (mode%strips(i))
               case (is_pressed)
                  stress = of%contact%a2(n)*xi - of%contact%b2(n)
                  if (n == 0) stress = stress - mode%depth(i)
               case (is_crushing)
                  stress = flow(1)*xi - flow(2)
                  if (n == 0) stress = stress + scene%d_y
               case default
                  cycle
               end select
               of%normal(n) = of%normal(n) + scene%kappa*scene%width*stress
               of%moment(n) = of%moment(n) + scene%kappa*scene%width*xi*stress
            end associate
         end do
      end associate
   end subroutine expand_strips

   !> Expand length and force of the tendon.
   pure subroutine expand_tendon(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series
      real(wp) :: square

      associate (of => series)
         of%cable%span_x(n) = of%x(n) + 2*scene%h*of%turn%sine(n)
         of%cable%span_z(n) = of%z(n) + 2*scene%h*of%turn%cosine(n)
         square = product_term(n, of%cable%span_x, of%cable%span_x) + product_term(n, &
            of%cable%span_z, of%cable%span_z)
         if (n == 0) then
            of%cable%length(0) = sqrt(square)
            of%tendon(0) = scene%eta_0 + scene%eta_slope*(of%cable%length(0) - scene%l_0)
         else
            of%cable%length(n) = root_term(n, square, of%cable%length)
            of%tendon(n) = scene%eta_slope*of%cable%length(n)
         end if
         of%cable%pull(n) = 0
         if (mode%is_taut) of%cable%pull(n) = quotient_term(n, scene%g*of%tendon(n), &
            of%cable%length, of%cable%pull)
      end associate
   end subroutine expand_tendon

   !> Expand strokes and forces of the devices. Each acts along the line that halves the rotation,
   !> on which the place at rest of a point of the base lies while the wall turns about a corner.
   pure subroutine expand_devices(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series
      real(wp) :: line(2), stroke, rate, force
      integer :: i

      associate (of => series, at => series%device)
         at%lift(n) = of%z(n)
         if (n == 0) then
            at%lift(0) = of%z(0) - scene%z_0
            at%sine(0) = sin(of%theta(0)/2)
            at%cosine(0) = cos(of%theta(0)/2)
         else
            at%sine(n) = at%sine_rate(n - 1)/n
            at%cosine(n) = -at%cosine_rate(n - 1)/n
         end if
         at%sine_rate(n) = product_term(n, at%cosine, of%theta_dot)/2
         at%cosine_rate(n) = product_term(n, at%sine, of%theta_dot)/2
         at%rise(n) = product_term(n, of%x, at%sine) + product_term(n, at%lift, at%cosine)
         at%arm(n) = (product_term(n, of%x, at%cosine) - product_term(n, at%lift, at%sine))/2
         at%rise_dot(n) = product_term(n, of%x_dot, at%sine) + product_term(n, of%z_dot, &
            at%cosine) + product_term(n, at%arm, of%theta_dot)
         at%force(n) = 0
         at%couple(n) = 0
         do i = 1, size(scene%devices)
            associate (device => scene%devices(i))
               stroke = at%rise(n) - 2*device%offset*at%sine(n)
               rate = at%rise_dot(n) - 2*device%offset*at%sine_rate(n)
               line = line_of_element(device, mode%springs)
               force = line(2)*stroke + device%c*rate
               if (n == 0) force = force + line(1)
               at%force(n) = at%force(n) + force
               at%couple(n) = at%couple(n) + device%offset*force
               if (device%spring == 0) cycle
               at%stretch(n, device%spring) = stroke
               at%stretch_dot(n, device%spring) = rate
            end associate
         end do
      end associate
   end subroutine expand_devices

   !> Expand the forces of storeys, dampers and links on w.
   pure subroutine expand_frame(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series
      integer :: i, j

      associate (of => series, frame => scene%frame)
         do i = 1, 2 + frame%free
            of%force(n, i) = frame%k(1, i)*of%x(n) + frame%k(2, i)*of%u(n) &
               + frame%c(1, i)*of%x_dot(n) + frame%c(2, i)*of%u_dot(n)
            do j = 1, frame%free
               of%force(n, i) = of%force(n, i) + frame%k(2 + j, i)*of%q(n, j) &
                  + frame%c(2 + j, i)*of%q_dot(n, j)
            end do
            if (i > 2) of%q_ddot(n, i - 2) = -of%force(n, i)/frame%m(i - 2) - of%ground(n)
         end do
         do i = scene%fuses + 1, size(scene%springs)
            of%device%stretch(n, i) = of%x(n) + of%u(n)
            of%device%stretch_dot(n, i) = of%x_dot(n) + of%u_dot(n)
            of%force(n, :) = of%force(n, :) + mode%springs(i)%slope*of%device%stretch(n, i)
            if (n == 0) of%force(n, :) = of%force(n, :) + mode%springs(i)%offset
         end do
      end associate
   end subroutine expand_frame

   !> Solve the rows of x, z and theta for the accelerations, and for H where the base sticks.
   pure subroutine accelerate(n, scene, mode, series)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_mode_t), intent(in) :: mode
      type(base_series_t), intent(inout) :: series
      real(wp) :: row(3)
      real(wp) :: mass
      !! that slips [-]
      real(wp) :: own
      !! inertia of the rotation, without what moves freely with it [m2]

      associate (of => series, h => scene%h)
         call sum_forces(n, scene, series, row)
         row(1) = row(1) - known(of%turn%lever, of%theta_ddot)
         row(2) = row(2) + h*known(of%turn%sine, of%theta_ddot)
         row(3) = row(3) + h*known(of%turn%sine, of%z_ddot) &
            - known(of%turn%inertia, of%theta_ddot)
         if (scene%slides) row(3) = row(3) - known(of%turn%lever, of%x_ddot)
         own = of%turn%inertia(0) - (h*of%turn%sine(0))**2
         if (.not. scene%slides .or. (mode%slip == 0 .and. mode%touches)) then
            of%theta_ddot(n) = (row(3) + h*of%turn%sine(0)*row(2))/own
            of%x_ddot(n) = 0
            of%shear(n) = of%turn%lever(0)*of%theta_ddot(n) - row(1)
         else
            of%shear(n) = 0
            if (mode%touches) of%shear(n) = -mode%slip*scene%mu*of%normal(n)
            row(1) = row(1) + of%shear(n)
            mass = 1 + scene%frame%mass(1, 1)
            of%theta_ddot(n) = (row(3) + h*of%turn%sine(0)*row(2) - of%turn%lever(0)*row(1)/mass) &
               /(own - of%turn%lever(0)**2/mass)
            of%x_ddot(n) = (row(1) - of%turn%lever(0)*of%theta_ddot(n))/mass
         end if
         of%z_ddot(n) = row(2) + h*of%turn%sine(0)*of%theta_ddot(n)
         of%u_ddot(n) = of%turn%bias(n) + product_term(n, of%turn%gain, of%theta_ddot)
      end associate

   contains

      !> Part of coefficient n of a product that needs only coefficients below n of the second
      !> series.
      pure real(wp) function known(a, b) result(c)
         real(wp), intent(in) :: a(0:highest_order), b(0:highest_order)
         integer :: k

         c = 0
         do k = 1, n
            c = c + a(k)*b(n - k)
         end do
      end function known
   end subroutine accelerate

   !> Sum the forces on x, z and theta that do not depend on the accelerations or on H.
   pure subroutine sum_forces(n, scene, series, row)
      integer, intent(in) :: n
      type(base_scene_t), intent(in) :: scene
      type(base_series_t), intent(inout) :: series
      real(wp), intent(out) :: row(3)
      !! coefficient n [m/s2], [m/s2], [m2/s2]
      real(wp) :: spin(2)

      associate (of => series, h => scene%h, frame => scene%frame)
         spin = [product_term(n, of%turn%sine_rate, of%theta_dot), &
            product_term(n, of%turn%cosine_rate, of%theta_dot)]
         of%turn%bias(n) = -2*h*spin(1) + scene%b*spin(2)
         of%turn%lever(n) = h*of%turn%cosine(n) + frame%mass(1, 2)*of%turn%gain(n)
         of%turn%inertia(n) = 0
         of%load%weight(n) = of%upward(n)
         if (n == 0) of%turn%inertia(0) = scene%inertia
         if (n == 0) of%load%weight(0) = of%upward(0) + scene%g
         row = [h*spin(1) - of%ground(n), of%normal(n) + h*spin(2) - of%load%weight(n), &
            h*of_motion(of%load%weight, of%turn%sine) - h*of_motion(of%ground, of%turn%cosine) &
            - product_term(n, of%turn%cosine, of%moment)]
         if (frame%n > 0) then
            of%turn%inertia(n) = of%turn%inertia(n) + frame%mass(2, 2)*product_term(n, &
               of%turn%gain, of%turn%gain)
            of%load%roof(n) = of%force(n, 2) + frame%excited(2)*of%ground(n) &
               + frame%mass(2, 2)*of%turn%bias(n)
            row(1) = row(1) - frame%excited(1)*of%ground(n) - of%force(n, 1) &
               - frame%mass(1, 2)*of%turn%bias(n)
            row(3) = row(3) - product_term(n, of%turn%gain, of%load%roof)
         end if
         of%anchor(n) = 0
         if (scene%has_tendon) then
            of%cable%arm(n) = -product_term(n, of%z, of%turn%sine)
            if (scene%slides) of%cable%arm(n) = of%cable%arm(n) &
               + product_term(n, of%x, of%turn%cosine)
            of%cable%arm(n) = 2*h*of%cable%arm(n)
            of%anchor(n) = product_term(n, of%cable%pull, of%cable%span_x)
            row = row - [of%anchor(n), product_term(n, of%cable%pull, of%cable%span_z), &
               product_term(n, of%cable%pull, of%cable%arm)]
         end if
         if (size(scene%devices) == 0) return
         associate (at => series%device)
            spin(1) = product_term(n, at%force, at%sine)
            of%anchor(n) = of%anchor(n) + spin(1)
            row = row - [spin(1), product_term(n, at%force, at%cosine), product_term(n, at%force, &
               at%arm) - product_term(n, at%couple, at%cosine)]
         end associate
      end associate

   contains

      !> Coefficient n of the product with a series of the ground's motion.
      pure real(wp) function of_motion(a, b) result(c)
         real(wp), intent(in) :: a(0:highest_order), b(0:highest_order)
         integer :: k

         c = 0
         do k = 0, min(n, series%degree)
            c = c + a(k)*b(n - k)
         end do
      end function of_motion
   end subroutine sum_forces

end module rwmf_model_base_base_series
