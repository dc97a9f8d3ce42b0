!> Lane loops of a bending wall: kinematics of its top, its modes, and floors that are linked to it
!> one by one.
!>
!> With q = side q_i, w = sum phi_i q_i and the mass m_w as unit, the kinetic energy of the wall is
!>
!>    T = 1/2 phi'**2 (I_0 - 2 b W_0 + W_2) + 1/2 sum m_i q_i'**2 + phi' sum S_i q_i',
!>    W_0 = sum A_i q_i,  W_2 = sum m_i q_i**2,
!>
!> and gravity has the potential g (b sin(phi) + h cos(phi) - sin(phi) W_0). Loops of the frame act
!> through the link on the top, whose displacement is R u + cos(phi) w(2h). Their force follows from
!> the moment that they have added.
module rwmf_model_effects_bending_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_bending, of_input, of_viscous, &
      power_count
   use rwmf_model_scene, only: term_t
   implicit none
   private

   public :: bend_wall, add_modes, release_modes, add_mode_power
   public :: bending_coefficients, most_modes, fixed_columns, floor_columns

   integer, parameter :: most_modes = 12
   !! upper limit of the key `modes`
   integer, parameter :: fixed_columns = 5
   !! R [m], b [m], g/R [1/s2], g [m/s2], damping over stiffness of linked floors [s]
   integer, parameter :: mode_columns = 5
   !! of each mode: A_i [-], S_i [m], m_i [-], stiffness [1/s2], damping [1/s]
   integer, parameter :: floor_columns = 4
   !! of each linked floor: share of the height [-], mass [-], stiffness [1/s2] and P-Delta
   !! stiffness [1/s2] of the storey below. The deflections of the modes follow. With link springs:
   !! share [-], reciprocal mass [-], stiffness of the spring [1/s2], 0.

contains

   !> Number of coefficients of `add_modes`.
   pure integer function bending_coefficients(n, floors) result(n_coef)
      integer, intent(in) :: n
      !! number of modes
      integer, intent(in) :: floors
      !! number of floors that are linked one by one

      n_coef = fixed_columns + (mode_columns + n)*n + (floor_columns + n)*floors
   end function bending_coefficients

   !> Replace kinematics, inertia and weight of the rigid wall by those of the bending wall. This
   !> loop comes before all others.
   pure subroutine bend_wall(n, coef, y, inertia, motion)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: coef(lane_count, fixed_columns + mode_columns*n)
      !! coefficients of `add_modes`
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: inertia(lane_count)
      !! inertia of the rigid wall over m_w R**2 [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: tip, tip_rate, lean, spread, sine, cosine
      integer :: i, j

      motion%is_bent = .true.
      !$omp simd private(tip, tip_rate, lean, spread, sine, cosine, j)
      do i = 1, lane_count
         tip = 0
         tip_rate = 0
         lean = 0
         spread = 0
         do j = 1, n
            tip = tip + y(i, j)
            tip_rate = tip_rate + y(i, n + j)
            lean = lean + coef(i, fixed_columns + j)*y(i, j)
            spread = spread + coef(i, fixed_columns + 2*n + j)*y(i, j)*y(i, j)
         end do
         tip = motion%side(i)*tip/coef(i, 1)
         tip_rate = motion%side(i)*tip_rate/coef(i, 1)
         lean = motion%side(i)*lean
         sine = 2*motion%half_sine(i)*motion%half_cosine(i)
         cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
         motion%u(i) = motion%u(i) + cosine*tip
         motion%j(i) = motion%j(i) - sine*tip
         motion%k(i) = motion%k(i) - cosine*tip
         motion%lever(i) = motion%j(i)
         motion%w_rate(i) = cosine*tip_rate
         motion%w_bias(i) = -2*sine*tip_rate*motion%rate(i)
         motion%s(i) = motion%s(i) - cosine*lean/coef(i, 1)
         motion%c(i) = motion%c(i) - sine*lean/coef(i, 1)
         motion%inertia(i) = inertia(i) + (spread - 2*coef(i, 2)*lean)/(coef(i, 1)*coef(i, 1))
         motion%moment(i) = -(coef(i, 3)*motion%s(i) + motion%c(i)*motion%push(i))
      end do
   end subroutine bend_wall

   !> Subtract the share of the modes from inertia and moment. The loops so far act through the link
   !> on the top. The accelerations of the modes, per phi'' and for phi'' = 0, are stored in y_dot
   !> for `release_modes`.
   pure subroutine add_modes(term, coef, y, inertia, motion, y_dot)
      type(term_t), intent(in) :: term
      !! its law is the number of modes n, its n the number of floors that are linked one by one
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! columns as above; after those of the modes, the linked mass matrix at phi = 0 by rows [-]
      real(wp), intent(in) :: y(lane_count, last_state(term))
      !! states
      real(wp), intent(in) :: inertia(lane_count)
      !! inertia of the rigid wall over m_w R**2 [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: y_dot(lane_count, last_state(term))
      !! rates of the states, for the modes accelerations per phi'' [m] and for phi'' = 0 [m/s2]
      real(wp) :: mass(lane_count, most_modes, most_modes), own(lane_count, most_modes, 2)
      real(wp), dimension(lane_count) :: sine, cosine, force, linked, drag, push
      integer :: i, j, n, q

      n = term%law
      q = term%state - 1
      associate (A => fixed_columns, S => fixed_columns + n, m => fixed_columns + 2*n, &
         k => fixed_columns + 3*n, c => fixed_columns + 4*n)
         drag = 0
         do j = 1, n
            !$omp simd
            do i = 1, lane_count
               drag(i) = drag(i) + y(i, q + n + j)*(coef(i, m + j)*motion%side(i)*y(i, q + j) &
                  - coef(i, 2)*coef(i, A + j))
            end do
         end do
         !$omp simd
         do i = 1, lane_count
            sine(i) = 2*motion%half_sine(i)*motion%half_cosine(i)
            cosine(i) = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
            ! force and mass at the top, over m_w
            force(i) = -(coef(i, 3)*motion%s(i) + motion%c(i)*motion%push(i)) - motion%moment(i)
            force(i) = coef(i, 1)*force(i)/motion%lever(i)
            push(i) = coef(i, 1)*motion%push(i)
            motion%moment(i) = motion%moment(i) - 2*motion%side(i)*drag(i)*motion%rate(i) &
               /(coef(i, 1)*coef(i, 1))
         end do
         call find_linked_mass(n, coef, y(1, q + 1), inertia, motion, linked)
         do j = 1, n
            !$omp simd
            do i = 1, lane_count
               own(i, j, 1) = coef(i, S + j) + linked(i)*coef(i, 1)*motion%j(i)*cosine(i)
               own(i, j, 2) = motion%rate(i)*motion%rate(i)*(coef(i, m + j)*motion%side(i) &
                  *y(i, q + j) - coef(i, 2)*coef(i, A + j)) &
                  - motion%side(i)*(coef(i, k + j)*y(i, q + j) + coef(i, c + j)*y(i, q + n + j)) &
                  + ((coef(i, 4) + motion%vertical(i))*sine(i) - push(i)*cosine(i))*coef(i, A + j) &
                  - cosine(i)*force(i)
            end do
         end do
         if (term%floors > 0) then
            call add_bent_springs(term, coef, y, sine, cosine, motion, own, y_dot)
         else if (term%n > 0) then
            call add_linked_floors(term, coef, y(1, q + 1), sine, cosine, motion, own)
         end if
         call put_masses(n, coef, cosine, mass)
         call solve_for_modes(n, mass, own, y_dot(1, q + 1))
         do j = 1, n
            !$omp simd
            do i = 1, lane_count
               motion%inertia(i) = motion%inertia(i) - own(i, j, 1)*y_dot(i, q + j)/(coef(i, 1) &
                  *coef(i, 1))
               motion%moment(i) = motion%moment(i) - own(i, j, 1)*y_dot(i, q + n + j)/(coef(i, 1) &
                  *coef(i, 1))
            end do
         end do
      end associate
   end subroutine add_modes

   !> Mass over m_w that moves with the top, from the inertia that the loops so far have added.
   pure subroutine find_linked_mass(n, coef, y, inertia, motion, linked)
      integer, intent(in) :: n
      real(wp), intent(in) :: coef(lane_count, fixed_columns + mode_columns*n)
      real(wp), intent(in) :: y(lane_count, 2*n)
      real(wp), intent(in) :: inertia(lane_count)
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(out) :: linked(lane_count)
      real(wp) :: lean, spread
      integer :: i, j

      !$omp simd private(lean, spread, j)
      do i = 1, lane_count
         lean = 0
         spread = 0
         do j = 1, n
            lean = lean + coef(i, fixed_columns + j)*y(i, j)
            spread = spread + coef(i, fixed_columns + 2*n + j)*y(i, j)*y(i, j)
         end do
         lean = motion%side(i)*lean
         linked(i) = motion%inertia(i) - (inertia(i) + (spread - 2*coef(i, 2)*lean)/(coef(i, 1) &
            *coef(i, 1)))
         linked(i) = linked(i)/(motion%lever(i)*motion%j(i))
      end do
   end subroutine find_linked_mass

   !> Add masses, storeys and dampers of floors that are linked one by one.
   pure subroutine add_linked_floors(term, coef, y, sine, cosine, motion, own)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 2*term%law)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: sine(lane_count), cosine(lane_count)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      real(wp), dimension(lane_count) :: tip, tip_rate, w, w_rate, j_floor, below, rate_below, &
         j_below, d, d_rate, shear, force, u, rate
      real(wp) :: phi_below
      integer :: i, j, floor, first

      associate (n => term%law, R => coef(:, 1))
         call deflect_top(n, y, motion%side, tip, tip_rate)
         below = 0
         rate_below = 0
         j_below = 0
         do floor = 1, term%n
            first = first_of_floor(n, floor)
            call deflect(n, coef(1, first + floor_columns + 1), y, motion%side, w, w_rate)
            associate (share => coef(:, first + 1), mass => coef(:, first + 2), &
                       k => coef(:, first + 3))
               u = share*(R*motion%u - cosine*tip) + cosine*w
               j_floor = share*(R*motion%j + sine*tip) - sine*w
               rate = j_floor*motion%rate + cosine*w_rate
               force = (share*(R*motion%k + cosine*tip) - cosine*w)*motion%rate**2 &
                  - 2*sine*motion%rate*w_rate + R*motion%push
               force = mass*force
               d = u - below
               d_rate = rate - rate_below
               shear = (k - coef(:, first + 4))*d + coef(:, 5)*k*d_rate
               motion%moment = motion%moment - (j_floor*force + (j_floor - j_below)*shear)/R**2
               motion%inertia = motion%inertia + mass*j_floor**2/R**2
            end associate
            do j = 1, n
               do i = 1, lane_count
                  phi_below = 0
                  if (floor > 1) phi_below = coef(i, first - n + j)
                  own(i, j, 1) = own(i, j, 1) + cosine(i)*coef(i, first + 2)*j_floor(i) &
                     *coef(i, first + floor_columns + j)
                  own(i, j, 2) = own(i, j, 2) - cosine(i)*(coef(i, first + floor_columns + j) &
                     *force(i) + (coef(i, first + floor_columns + j) - phi_below)*shear(i))
               end do
            end do
            below = u
            rate_below = rate
            j_below = j_floor
         end do
      end associate
   end subroutine add_linked_floors

   !> Add the forces of springs between wall and floors, on both.
   pure subroutine add_bent_springs(term, coef, y, sine, cosine, motion, own, y_dot)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, last_state(term))
      !! states
      real(wp), intent(in) :: sine(lane_count), cosine(lane_count)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      real(wp), intent(inout) :: y_dot(lane_count, last_state(term))
      !! rates of the states; the springs add to those of the floors' velocities [m/s2]
      real(wp), dimension(lane_count) :: tip, tip_rate, w, w_rate, pull
      integer :: j, floor, first

      associate (n => term%law, R => coef(:, 1), last => term%floors + term%n - 1)
         call deflect_top(n, y(1, term%state), motion%side, tip, tip_rate)
         do floor = 1, term%n
            first = first_of_floor(n, floor)
            call deflect(n, coef(1, first + floor_columns + 1), y(1, term%state), motion%side, w, &
               w_rate)
            associate (share => coef(:, first + 1))
               pull = coef(:, first + 3)*(share*(R*motion%u - cosine*tip) + cosine*w &
                  - motion%side*y(:, term%floors - 1 + floor))
               motion%moment = motion%moment - (share*(R*motion%j + sine*tip) - sine*w)*pull/R**2
            end associate
            do j = 1, n
               own(:, j, 2) = own(:, j, 2) - cosine*coef(:, first + floor_columns + j)*pull
            end do
            y_dot(:, last + floor) = y_dot(:, last + floor) + motion%side*pull*coef(:, first + 2)
         end do
      end associate
   end subroutine add_bent_springs

   !> Index of the last state of the modes.
   pure integer function last_state(term)
      type(term_t), intent(in) :: term

      last_state = term%state + 2*term%law - 1
   end function last_state

   !> Number of coefficients before those of a floor.
   pure integer function first_of_floor(n, floor) result(first)
      integer, intent(in) :: n
      !! number of modes
      integer, intent(in) :: floor
      !! number of the floor

      first = fixed_columns + (mode_columns + n)*n + (floor - 1)*(floor_columns + n)
   end function first_of_floor

   !> Deflection and its rate at a place of the wall.
   pure subroutine deflect(n, phi, y, side, w, w_rate)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: phi(lane_count, n)
      !! deflection of each mode at this place [-]
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: side(lane_count)
      !! +1 or -1 [-]
      real(wp), intent(out) :: w(lane_count)
      !! [m]
      real(wp), intent(out) :: w_rate(lane_count)
      !! [m/s]
      integer :: j

      w = 0
      w_rate = 0
      do j = 1, n
         w = w + phi(:, j)*side*y(:, j)
         w_rate = w_rate + phi(:, j)*side*y(:, n + j)
      end do
   end subroutine deflect

   !> Deflection and its rate at the top of the wall, where every mode is 1.
   pure subroutine deflect_top(n, y, side, w, w_rate)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: side(lane_count)
      !! +1 or -1 [-]
      real(wp), intent(out) :: w(lane_count)
      !! [m]
      real(wp), intent(out) :: w_rate(lane_count)
      !! [m/s]

      w = side*sum(y(:, :n), dim=2)
      w_rate = side*sum(y(:, n + 1:), dim=2)
   end subroutine deflect_top

   !> Compute the mass matrix of the modes with the linked masses.
   pure subroutine put_masses(n, coef, cosine, mass)
      integer, intent(in) :: n
      real(wp), intent(in) :: coef(lane_count, fixed_columns + (mode_columns + n)*n)
      real(wp), intent(in) :: cosine(lane_count)
      real(wp), intent(out) :: mass(lane_count, most_modes, most_modes)
      integer :: i, j, k

      do j = 1, n
         do k = 1, j
            !$omp simd
            do i = 1, lane_count
               mass(i, k, j) = cosine(i)*cosine(i)*coef(i, fixed_columns &
                  + (mode_columns + j - 1)*n + k)
            end do
         end do
         !$omp simd
         do i = 1, lane_count
            mass(i, j, j) = mass(i, j, j) + coef(i, fixed_columns + 2*n + j)
         end do
      end do
   end subroutine put_masses

   !> Solve for the accelerations of the modes, per phi'' and for phi'' = 0, by Cholesky factors.
   pure subroutine solve_for_modes(n, mass, right, solution)
      integer, intent(in) :: n
      real(wp), intent(inout) :: mass(lane_count, most_modes, most_modes)
      !! upper triangle; on return its factor, with one over the diagonal
      real(wp), intent(in) :: right(lane_count, most_modes, 2)
      real(wp), intent(inout) :: solution(lane_count, n, 2)
      integer :: i, j, k, m

      do j = 1, n
         do k = 1, j
            do m = 1, k - 1
               !$omp simd
               do i = 1, lane_count
                  mass(i, k, j) = mass(i, k, j) - mass(i, m, k)*mass(i, m, j)
               end do
            end do
            if (k == j) exit
            mass(:, k, j) = mass(:, k, j)*mass(:, k, k)
         end do
         mass(:, j, j) = 1/sqrt(mass(:, j, j))
      end do
      do m = 1, 2
         do j = 1, n
            solution(:, j, m) = right(:, j, m)
            do k = 1, j - 1
               !$omp simd
               do i = 1, lane_count
                  solution(i, j, m) = solution(i, j, m) - mass(i, k, j)*solution(i, k, m)
               end do
            end do
            solution(:, j, m) = solution(:, j, m)*mass(:, j, j)
         end do
         do j = n, 1, -1
            do k = j + 1, n
               !$omp simd
               do i = 1, lane_count
                  solution(i, j, m) = solution(i, j, m) - mass(i, j, k)*solution(i, k, m)
               end do
            end do
            solution(:, j, m) = solution(:, j, m)*mass(:, j, j)
         end do
      end do
   end subroutine solve_for_modes

   !> Compute the rates of the modes from phi''.
   pure subroutine release_modes(n, y, side, theta_ddot, y_dot)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: side(lane_count)
      !! +1 or -1 [-]
      real(wp), intent(in) :: theta_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(inout) :: y_dot(lane_count, 2*n)
      !! as set by `add_modes`; on return the rates [m/s], [m/s2]
      integer :: i, j

      do j = 1, n
         !$omp simd
         do i = 1, lane_count
            y_dot(i, n + j) = side(i)*y_dot(i, n + j) - y_dot(i, j)*theta_ddot(i)
            y_dot(i, j) = y(i, n + j)
         end do
      end do
   end subroutine release_modes

   !> Add the powers of the ground motion on the modes, of their dampers and of linked floors.
   pure subroutine add_mode_power(term, weight, coef, y, motion, total)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients of `add_modes`
      real(wp), intent(in) :: y(lane_count, 2*term%law)
      !! q_i [m] and q_i' [m/s]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp), dimension(lane_count) :: sine, cosine, lean_rate, own
      integer :: j

      lean_rate = 0
      own = 0
      associate (n => term%law, R => coef(:, 1))
         do j = 1, n
            lean_rate = lean_rate + coef(:, fixed_columns + j)*motion%side*y(:, n + j)
            own = own + coef(:, fixed_columns + 4*n + j)*y(:, n + j)**2
         end do
         sine = 2*motion%half_sine*motion%half_cosine
         cosine = 1 - 2*motion%half_sine**2
         total(:, of_bending) = total(:, of_bending) + weight*own/R**2
         total(:, of_input) = total(:, of_input) + weight*lean_rate*(motion%vertical*sine &
            - R*motion%push*cosine)/R**2
      end associate
      if (term%floors == 0) call add_linked_floor_power(term, weight, coef, y, motion, total)
   end subroutine add_mode_power

   !> Add the powers of the ground motion on linked floors and of their dampers.
   pure subroutine add_linked_floor_power(term, weight, coef, y, motion, total)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 2*term%law)
      !! q_i [m] and q_i' [m/s]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp), dimension(lane_count) :: sine, cosine, tip, tip_rate, w, w_rate, rate, below
      integer :: floor, first

      sine = 2*motion%half_sine*motion%half_cosine
      cosine = 1 - 2*motion%half_sine**2
      associate (n => term%law, R => coef(:, 1))
         call deflect_top(n, y, motion%side, tip, tip_rate)
         below = 0
         do floor = 1, term%n
            first = first_of_floor(n, floor)
            call deflect(n, coef(1, first + floor_columns + 1), y, motion%side, w, w_rate)
            rate = (coef(:, first + 1)*(R*motion%j + sine*tip) - sine*w)*motion%rate &
               + cosine*w_rate
            total(:, of_viscous) = total(:, of_viscous) + weight*coef(:, 5)*coef(:, first + 3) &
               *(rate - below)**2/R**2
            total(:, of_input) = total(:, of_input) - weight*coef(:, first + 2)*motion%push &
               *rate/R
            below = rate
         end do
      end associate
   end subroutine add_linked_floor_power

end module rwmf_model_effects_bending_loop
