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
!>
!> The mass matrix of the modes is M + cos(phi)**2 L, with the linked mass matrix L. Both are
!> diagonal in the vectors V with V**T M V = 1 and V**T L V = diag(lambda).
!>
!> Floors move with n + 1 shapes: the straight wall, number 0, and the modes. Sums over floors
!> become constant matrices of these shapes.
module rwmf_model_effects_bending_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen_loop, only: raise_state
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_bending, of_input, of_plastic, &
      of_viscous, power_count
   use rwmf_model_scene, only: term_t
   implicit none
   private

   public :: bend_wall, add_modes, release_modes, add_mode_power
   public :: bending_coefficients, fixed_columns, mode_columns, shape_columns, spring_columns
   public :: smooth_columns, first_of_shape, first_smooth

   integer, parameter :: most_modes = 12
   !! upper limit of the key `modes`
   integer, parameter :: fixed_columns = 4
   !! R [m], b [m], g/R [1/s2], g [m/s2]
   integer, parameter :: mode_columns = 6
   !! of each mode: A_i [-], S_i [m], m_i [-], stiffness [1/s2], damping [1/s], lambda_i [-]. The
   !! columns of V follow [-].
   integer, parameter :: shape_columns = 2
   !! of each shape with linked floors: mass [-], force of yielded storeys [m/s2]. The rows of mass
   !! [-], stiffness [1/s2] and damping matrix [1/s] follow.
   integer, parameter :: smooth_columns = 4
   !! of each smooth storey of linked floors: force at z = 1 [m/s2], reciprocal yield displacement
   !! [1/m], lost part [-], exponent [-]. Its displacements in the shapes follow [-].
   integer, parameter :: spring_columns = 2
   !! of each link spring: reciprocal mass of its floor [-], stiffness [1/s2]. The deflections of
   !! the shapes follow.

   !> Displacements of the shapes of all lanes, in the direction of the present side.
   type :: shapes_t
      real(wp) :: place(lane_count, 0:most_modes)
      !! displacement [m]
      real(wp) :: rate(lane_count, 0:most_modes)
      !! velocity [m/s]
      real(wp) :: slope(lane_count, 0:most_modes)
      !! derivative of the displacement by phi [m]
      real(wp) :: bias(lane_count, 0:most_modes)
      !! acceleration for phi'' = 0 and q'' = 0 [m/s2]
   end type shapes_t

contains

   !> Number of coefficients of `add_modes`.
   pure integer function bending_coefficients(n, floors, has_springs, are_smooth) result(n_coef)
      integer, intent(in) :: n
      !! number of modes
      integer, intent(in) :: floors
      !! number of floors that are linked one by one
      logical, intent(in) :: has_springs
      !! the links of these floors are springs
      logical, intent(in) :: are_smooth
      !! the storeys of these floors have smooth hysteresis

      n_coef = fixed_columns + (mode_columns + n)*n
      if (floors == 0) return
      if (has_springs) then
         n_coef = n_coef + (spring_columns + n + 1)*floors
      else
         n_coef = n_coef + (shape_columns + 3*(n + 1))*(n + 1)
         if (are_smooth) n_coef = n_coef + (smooth_columns + n + 1)*floors
      end if
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
      !! columns as above, with their units
      real(wp), intent(in) :: y(lane_count, last_state(term))
      !! states
      real(wp), intent(in) :: inertia(lane_count)
      !! inertia of the rigid wall over m_w R**2 [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: y_dot(lane_count, last_state(term))
      !! rates of the states, for the modes accelerations per phi'' [m] and for phi'' = 0 [m/s2],
      !! both in the vectors V
      real(wp) :: own(lane_count, most_modes, 2)
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
                  + ((coef(i, 4) + motion%upward(i))*sine(i) - push(i)*cosine(i))*coef(i, A + j) &
                  - cosine(i)*force(i)
            end do
         end do
      end associate
      if (term%floors > 0) then
         call add_bent_springs(term, coef, y, motion, own, y_dot)
      else if (term%n > 0) then
         call add_linked_floors(term, coef, y(1, q + 1), motion, own)
         if (term%n_states > 2*n) call add_smooth_storeys(term, coef, y(1, q + 1), motion, own, &
            y_dot(1, q + 1))
      end if
      call eliminate_modes(n, coef, cosine, own, motion, y_dot(1, q + 1))
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

   !> Compute the displacements of the shapes.
   pure subroutine move_shapes(n, radius, y, motion, shapes)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: radius(lane_count)
      !! R [m]
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      type(lane_motion_t), intent(in) :: motion
      type(shapes_t), intent(out) :: shapes
      real(wp), dimension(lane_count) :: sine, cosine, tip
      integer :: i, j

      !$omp simd
      do i = 1, lane_count
         sine(i) = 2*motion%half_sine(i)*motion%half_cosine(i)
         cosine(i) = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
         tip(i) = 0
      end do
      do j = 1, n
         !$omp simd
         do i = 1, lane_count
            shapes%place(i, j) = cosine(i)*motion%side(i)*y(i, j)
            shapes%slope(i, j) = -sine(i)*motion%side(i)*y(i, j)
            shapes%rate(i, j) = shapes%slope(i, j)*motion%rate(i) + cosine(i)*motion%side(i) &
               *y(i, n + j)
            shapes%bias(i, j) = -(shapes%place(i, j)*motion%rate(i) + 2*sine(i)*motion%side(i) &
               *y(i, n + j))*motion%rate(i)
            tip(i) = tip(i) + motion%side(i)*y(i, j)
         end do
      end do
      ! the kinematics are those of the top of the bent wall
      !$omp simd
      do i = 1, lane_count
         shapes%place(i, 0) = radius(i)*motion%u(i) - cosine(i)*tip(i)
         shapes%slope(i, 0) = radius(i)*motion%j(i) + sine(i)*tip(i)
         shapes%rate(i, 0) = shapes%slope(i, 0)*motion%rate(i)
         shapes%bias(i, 0) = (radius(i)*motion%k(i) + cosine(i)*tip(i))*motion%rate(i) &
            *motion%rate(i)
      end do
   end subroutine move_shapes

   !> Add masses, storeys and dampers of floors that are linked one by one.
   pure subroutine add_linked_floors(term, coef, y, motion, own)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 2*term%law)
      !! q_i [m] and q_i' [m/s]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      type(shapes_t) :: shapes
      real(wp) :: force(lane_count, 0:most_modes), mass(lane_count, 0:most_modes), cosine
      integer :: i, j, k, row

      associate (n => term%law)
         call move_shapes(n, coef(1, 1), y, motion, shapes)
         do j = 0, n
            row = first_of_shape(n, j) + shape_columns + 1
            !$omp simd private(k)
            do i = 1, lane_count
               force(i, j) = coef(i, row - 2)*coef(i, 1)*motion%push(i) + motion%side(i) &
                  *coef(i, row - 1)
               mass(i, j) = 0
               do k = 0, n
                  force(i, j) = force(i, j) + coef(i, row + k)*shapes%bias(i, k) + coef(i, row + n &
                     + 1 + k)*shapes%place(i, k) + coef(i, row + 2*(n + 1) + k)*shapes%rate(i, k)
                  mass(i, j) = mass(i, j) + coef(i, row + k)*shapes%slope(i, k)
               end do
               motion%moment(i) = motion%moment(i) - shapes%slope(i, j)*force(i, j)/(coef(i, 1) &
                  *coef(i, 1))
               motion%inertia(i) = motion%inertia(i) + shapes%slope(i, j)*mass(i, j)/(coef(i, 1) &
                  *coef(i, 1))
            end do
         end do
         do j = 1, n
            !$omp simd private(cosine)
            do i = 1, lane_count
               cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
               own(i, j, 1) = own(i, j, 1) + cosine*mass(i, j)
               own(i, j, 2) = own(i, j, 2) - cosine*force(i, j)
            end do
         end do
      end associate
   end subroutine add_linked_floors

   !> Add the hysteretic shears of smooth storeys and compute the rates of their states.
   pure subroutine add_smooth_storeys(term, coef, y, motion, own, y_dot)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, term%n_states)
      !! q_i [m], q_i' [m/s] and the states z of the storeys [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      real(wp), intent(inout) :: y_dot(lane_count, term%n_states)
      !! rates; those of z are set here [1/s]
      type(shapes_t) :: shapes
      real(wp), dimension(lane_count) :: power, rate, shear
      integer :: i, k, row, storey

      associate (n => term%law, floors => term%n, first => first_smooth(term))
         call move_shapes(n, coef(1, 1), y, motion, shapes)
         do storey = 1, floors
            row = first + smooth_columns*floors + storey
            call raise_state(0, coef(1, first + 3*floors + storey), y(1, 2*n + storey), power)
            rate = 0
            do k = 0, n
               rate = rate + coef(:, row + k*floors)*shapes%rate(:, k)
            end do
            !$omp simd
            do i = 1, lane_count
               y_dot(i, 2*n + storey) = motion%side(i)*coef(i, first + floors + storey)*rate(i) &
                  *(1 - coef(i, first + 2*floors + storey)*power(i))
               shear(i) = motion%side(i)*coef(i, first + storey)*y(i, 2*n + storey)
            end do
            do k = 0, n
               motion%moment = motion%moment - coef(:, row + k*floors)*shapes%slope(:, k)*shear &
                  /(coef(:, 1)*coef(:, 1))
            end do
            do k = 1, n
               own(:, k, 2) = own(:, k, 2) - (1 - 2*motion%half_sine*motion%half_sine) &
                  *coef(:, row + k*floors)*shear
            end do
         end do
      end associate
   end subroutine add_smooth_storeys

   !> Index of the column before those of smooth storeys.
   pure integer function first_smooth(term)
      type(term_t), intent(in) :: term

      first_smooth = first_of_shape(term%law, term%law + 1)
   end function first_smooth

   !> Add the forces of springs between wall and floors, on both.
   pure subroutine add_bent_springs(term, coef, y, motion, own, y_dot)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, last_state(term))
      !! states
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      real(wp), intent(inout) :: y_dot(lane_count, last_state(term))
      !! rates of the states; the springs add to those of the floors' velocities [m/s2]
      type(shapes_t) :: shapes
      real(wp) :: pull(lane_count)
      integer :: i, k, floor, row, first

      first = term%floors - 1
      associate (n => term%law)
         call move_shapes(n, coef(1, 1), y(1, term%state), motion, shapes)
         do floor = 1, term%n
            row = fixed_columns + (mode_columns + n)*n + (floor - 1)*(spring_columns + n + 1) + 3
            !$omp simd private(k)
            do i = 1, lane_count
               pull(i) = -motion%side(i)*y(i, first + floor)
               do k = 0, n
                  pull(i) = pull(i) + coef(i, row + k)*shapes%place(i, k)
               end do
               pull(i) = coef(i, row - 1)*pull(i)
               y_dot(i, first + term%n + floor) = y_dot(i, first + term%n + floor) &
                  + motion%side(i)*pull(i)*coef(i, row - 2)
               do k = 0, n
                  motion%moment(i) = motion%moment(i) - coef(i, row + k)*shapes%slope(i, k) &
                     *pull(i)/(coef(i, 1)*coef(i, 1))
               end do
            end do
            do k = 1, n
               !$omp simd
               do i = 1, lane_count
                  own(i, k, 2) = own(i, k, 2) - (1 - 2*motion%half_sine(i)*motion%half_sine(i)) &
                     *coef(i, row + k)*pull(i)
               end do
            end do
         end do
      end associate
   end subroutine add_bent_springs

   !> Index of the last state of the modes and of smooth storeys.
   pure integer function last_state(term)
      type(term_t), intent(in) :: term

      last_state = term%state + term%n_states - 1
   end function last_state

   !> Number of coefficients before those of a shape with linked floors.
   pure integer function first_of_shape(n, shape) result(first)
      integer, intent(in) :: n
      !! number of modes
      integer, intent(in) :: shape
      !! number of the shape

      first = fixed_columns + (mode_columns + n)*n + shape*(shape_columns + 3*(n + 1))
   end function first_of_shape

   !> Solve for the accelerations of the modes in the vectors V, per phi'' and for phi'' = 0, and
   !> subtract their share from inertia and moment.
   pure subroutine eliminate_modes(n, coef, cosine, own, motion, solution)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: coef(lane_count, fixed_columns + (mode_columns + n)*n)
      real(wp), intent(in) :: cosine(lane_count)
      !! cos(phi) [-]
      real(wp), intent(in) :: own(lane_count, most_modes, 2)
      !! coupling and force of each mode [m], [m/s2]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: solution(lane_count, n, 2)
      !! accelerations in the vectors V [m], [m/s2]
      real(wp) :: coupling, force, share
      integer :: i, j, k, row

      do j = 1, n
         row = fixed_columns + (mode_columns + j - 1)*n
         !$omp simd private(coupling, force, share, k)
         do i = 1, lane_count
            coupling = 0
            force = 0
            do k = 1, n
               coupling = coupling + coef(i, row + k)*own(i, k, 1)
               force = force + coef(i, row + k)*own(i, k, 2)
            end do
            share = coupling/(1 + cosine(i)*cosine(i)*coef(i, fixed_columns + 5*n + j))
            solution(i, j, 1) = share
            solution(i, j, 2) = force/(1 + cosine(i)*cosine(i)*coef(i, fixed_columns + 5*n + j))
            motion%inertia(i) = motion%inertia(i) - coupling*share/(coef(i, 1)*coef(i, 1))
            motion%moment(i) = motion%moment(i) - force*share/(coef(i, 1)*coef(i, 1))
         end do
      end do
   end subroutine eliminate_modes

   !> Compute the rates of the modes from phi''.
   pure subroutine release_modes(n, coef, y, side, theta_ddot, y_dot)
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: coef(lane_count, fixed_columns + (mode_columns + n)*n)
      !! coefficients of `add_modes`
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! q_i [m] and q_i' [m/s]
      real(wp), intent(in) :: side(lane_count)
      !! +1 or -1 [-]
      real(wp), intent(in) :: theta_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(inout) :: y_dot(lane_count, 2*n)
      !! as set by `add_modes`; on return the rates [m/s], [m/s2]
      real(wp) :: own(lane_count, most_modes), total
      integer :: i, j, k

      do j = 1, n
         !$omp simd
         do i = 1, lane_count
            own(i, j) = side(i)*y_dot(i, n + j) - y_dot(i, j)*theta_ddot(i)
         end do
      end do
      do j = 1, n
         !$omp simd private(total, k)
         do i = 1, lane_count
            total = 0
            do k = 1, n
               total = total + coef(i, fixed_columns + (mode_columns + k - 1)*n + j)*own(i, k)
            end do
            y_dot(i, n + j) = total
            y_dot(i, j) = y(i, n + j)
         end do
      end do
   end subroutine release_modes

   !> Add the powers of the ground motion on the modes, of their dampers and of linked floors.
   pure subroutine add_mode_power(term, weight, coef, y, y_dot, motion, total)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients of `add_modes`
      real(wp), intent(in) :: y(lane_count, term%n_states), y_dot(lane_count, term%n_states)
      !! q_i [m], q_i' [m/s] and the states z of smooth storeys [-], with their rates
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
         total(:, of_input) = total(:, of_input) + weight*lean_rate*(motion%upward*sine &
            - R*motion%push*cosine)/R**2
      end associate
      if (term%floors > 0 .or. term%n == 0) return
      call add_linked_floor_power(term, weight, coef, y, motion, total)
      if (term%n_states > 2*term%law) call add_smooth_power(term, weight, coef, y, y_dot, motion, &
         total)
   end subroutine add_mode_power

   !> Add the power dissipated by plastic flow of smooth storeys.
   pure subroutine add_smooth_power(term, weight, coef, y, y_dot, motion, total)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, term%n_states), y_dot(lane_count, term%n_states)
      !! q_i [m], q_i' [m/s] and the states z of the storeys [-], with their rates
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      type(shapes_t) :: shapes
      real(wp) :: rate(lane_count)
      integer :: k, storey

      associate (n => term%law, floors => term%n, first => first_smooth(term), R => coef(:, 1))
         call move_shapes(n, coef(1, 1), y, motion, shapes)
         do storey = 1, floors
            rate = 0
            do k = 0, n
               rate = rate + coef(:, first + smooth_columns*floors + storey + k*floors) &
                  *shapes%rate(:, k)
            end do
            total(:, of_plastic) = total(:, of_plastic) + weight*coef(:, first + storey) &
               *y(:, 2*n + storey)*(motion%side*rate - y_dot(:, 2*n + storey) &
               /coef(:, first + floors + storey))/R**2
         end do
      end associate
   end subroutine add_smooth_power

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
      type(shapes_t) :: shapes
      integer :: j, k, row

      associate (n => term%law, R => coef(:, 1))
         call move_shapes(n, coef(1, 1), y, motion, shapes)
         do j = 0, n
            row = first_of_shape(n, j) + shape_columns + 1 + 2*(n + 1)
            do k = 0, n
               total(:, of_viscous) = total(:, of_viscous) + weight*coef(:, row + k) &
                  *shapes%rate(:, j)*shapes%rate(:, k)/R**2
            end do
            total(:, of_input) = total(:, of_input) - weight*coef(:, first_of_shape(n, j) + 1) &
               *motion%push*shapes%rate(:, j)/R
         end do
      end associate
   end subroutine add_linked_floor_power

end module rwmf_model_effects_bending_loop
