!> Frame with storeys in the equation of motion, for all lanes. With all modes, the floors below the
!> roof have states, and with link springs the roof, too; with one mode no floor has.
module rwmf_model_effects_storeys_storeys_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen_loop, only: hysteretic_rate, raise_state
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_input, of_plastic, of_viscous, &
      power_count
   use rwmf_model_scene, only: term_t
   implicit none
   private

   public :: add_floors, add_excited_mass, add_floor_power, add_excited_mass_power, follow_storeys
   public :: move_storeys
   public :: no_hysteresis, floor_coefficients, floor_states, free_floors

   integer, parameter :: no_hysteresis = -1
   !! law of storeys on straight lines; other values are the factors of Bouc and Wen's power

contains

   !> Number of coefficients of `add_floors`.
   pure integer function floor_coefficients(n, free, law) result(n_coef)
      integer, intent(in) :: n
      !! number of storeys
      integer, intent(in) :: free
      !! number of floors with states
      integer, intent(in) :: law
      !! `no_hysteresis`, or smooth storeys

      n_coef = 1 + 3*n + n**2
      if (law /= no_hysteresis) n_coef = n_coef + 4*n
      if (free == n) n_coef = n_coef + 2*n
   end function floor_coefficients

   !> Number of states of the floors and of smooth storeys in `add_floors`.
   pure integer function floor_states(n, free, law) result(n_states)
      integer, intent(in) :: n
      !! number of storeys
      integer, intent(in) :: free
      !! number of floors with states
      integer, intent(in) :: law
      !! `no_hysteresis`, or smooth storeys

      n_states = 2*free
      if (law /= no_hysteresis) n_states = n_states + n
   end function floor_states

   !> Number of floors with states: n - 1 below a linked roof, n with link springs.
   pure integer function free_floors(term) result(free)
      type(term_t), intent(in) :: term
      !! loop of storeys with all modes

      free = term%n_states
      if (term%law /= no_hysteresis) free = free - term%n
      free = free/2
   end function free_floors

   !> Compute the rates of the floors with states, and add the force of the uppermost storey, or of
   !> the link springs, to the moment.
   pure subroutine add_floors(term, coef, y, motion, y_dot)
      type(term_t), intent(in) :: term
      !! n storeys, from the ground to the roof; law: `no_hysteresis`, or the factors of the power
      !! of smooth storeys (`raise_state`)
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! R [m]; slope [1/s2] and offset [m/s2] of each storey's line, over the unit of mass;
      !! reciprocal mass of each floor [-]; damping by rows [1/s]. Smooth storeys append the
      !! force at z = 1 [m/s2], reciprocal yield displacement [1/m], lost part [-], exponent [-].
      !! Link springs append their relative height [-] and stiffness [1/s2]
      real(wp), intent(in) :: y(lane_count, term%n_states)
      !! displacements [m] and velocities [m/s] of these floors, states z of smooth storeys [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: y_dot(lane_count, term%n_states)
      !! rates of these states, all set here [m/s], [m/s2], [1/s]
      real(wp) :: u_roof(lane_count), v_roof(lane_count)
      !! displacement and velocity of the roof [m], [m/s]
      real(wp) :: shear(lane_count, term%n + 1)
      !! shear of the columns of each storey; zero above the roof [m/s2]
      real(wp) :: force(lane_count)
      !! resisting force on a floor [m/s2]
      integer :: n, free
      !! numbers of storeys and of floors with states
      integer :: damping
      !! index of the column before those of a floor's damping
      integer :: i, j, k

      n = term%n
      free = free_floors(term)
      damping = 3*n + 1
      !$omp simd
      do i = 1, lane_count
         u_roof(i) = coef(i, 1)*(motion%side(i)*motion%u(i))
         v_roof(i) = coef(i, 1)*(motion%side(i)*motion%j(i)*motion%rate(i))
         shear(i, n + 1) = 0
      end do
      if (motion%is_bent) v_roof = v_roof + coef(:, 1)*motion%side*motion%w_rate
      call find_shears(n, free, coef, y, u_roof, shear)
      if (term%law /= no_hysteresis) call add_smooth_shears(n, free, term%law, &
         coef(1, 3*n + 2 + n**2), y, v_roof, shear, y_dot)
      do j = 1, n
         !$omp simd
         do i = 1, lane_count
            force(i) = shear(i, j) - shear(i, j + 1)
         end do
         do k = 1, free
            !$omp simd
            do i = 1, lane_count
               force(i) = force(i) + coef(i, damping + k)*y(i, free + k)
            end do
         end do
         damping = damping + n
         if (free < n) then
            !$omp simd
            do i = 1, lane_count
               force(i) = force(i) + coef(i, damping)*v_roof(i)
            end do
            if (j == n) exit
         end if
         !$omp simd
         do i = 1, lane_count
            y_dot(i, j) = y(i, free + j)
            y_dot(i, free + j) = -(coef(i, 2*n + 1 + j)*force(i) + motion%ground(i))
         end do
      end do
      if (free == n) call add_link_springs(n, coef(1, 2*n + 2), coef(1, term%n_coef - 2*n + 1), y, &
         u_roof, force, y_dot)
      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - motion%lever(i)*(motion%side(i)*force(i)/coef(i, 1))
      end do
   end subroutine add_floors

   !> Add the forces of the link springs to the rates of the floors, and compute the force at the
   !> roof that has the same moment on the wall.
   pure subroutine add_link_springs(n, per_mass, coef, y, u_roof, force, y_dot)
      integer, intent(in) :: n
      !! number of floors
      real(wp), intent(in) :: per_mass(lane_count, n)
      !! reciprocal mass of each floor [-]
      real(wp), intent(in) :: coef(lane_count, 2*n)
      !! relative height [-] and stiffness [1/s2] of each spring
      real(wp), intent(in) :: y(lane_count, 2*n)
      !! displacements [m] and velocities [m/s] of the floors
      real(wp), intent(in) :: u_roof(lane_count)
      !! displacement of the wall at the roof [m]
      real(wp), intent(out) :: force(lane_count)
      !! force of the springs on the floors, at the roof [m/s2]
      real(wp), intent(inout) :: y_dot(lane_count, 2*n)
      !! rates of these states [m/s], [m/s2]; the springs add to those of the velocities
      real(wp) :: pull
      integer :: i, j

      force = 0
      do j = 1, n
         !$omp simd private(pull)
         do i = 1, lane_count
            pull = coef(i, n + j)*(coef(i, j)*u_roof(i) - y(i, j))
            y_dot(i, n + j) = y_dot(i, n + j) + per_mass(i, j)*pull
            force(i) = force(i) + coef(i, j)*pull
         end do
      end do
   end subroutine add_link_springs

   !> Compute the shears of storeys on straight lines.
   pure subroutine find_shears(n, free, coef, u, u_roof, shear)
      integer, intent(in) :: n
      integer, intent(in) :: free
      real(wp), intent(in) :: coef(lane_count, 2*n + 1)
      !! first coefficients of `add_floors`
      real(wp), intent(in) :: u(lane_count, free)
      !! displacements of the floors with states [m]
      real(wp), intent(in) :: u_roof(lane_count)
      !! displacement of the roof [m]
      real(wp), intent(inout) :: shear(lane_count, n + 1)
      real(wp) :: below(lane_count)
      integer :: i, j

      below = 0
      do j = 1, free
         !$omp simd
         do i = 1, lane_count
            shear(i, j) = coef(i, 1 + j)*(u(i, j) - below(i)) + coef(i, n + 1 + j)
            below(i) = u(i, j)
         end do
      end do
      if (free == n) return
      !$omp simd
      do i = 1, lane_count
         shear(i, n) = coef(i, 1 + n)*(u_roof(i) - below(i)) + coef(i, 2*n + 1)
      end do
   end subroutine find_shears

   !> Add the hysteretic shears of smooth storeys and compute the rates of their states.
   pure subroutine add_smooth_shears(n, free, factors, coef, y, v_roof, shear, y_dot)
      integer, intent(in) :: n
      integer, intent(in) :: free
      integer, intent(in) :: factors
      real(wp), intent(in) :: coef(lane_count, 4*n)
      !! coefficients of smooth storeys, see `add_floors`
      real(wp), intent(in) :: y(lane_count, 2*free + n)
      !! states of `add_floors`
      real(wp), intent(in) :: v_roof(lane_count)
      !! velocity of the roof [m/s]
      real(wp), intent(inout) :: shear(lane_count, n + 1)
      real(wp), intent(inout) :: y_dot(lane_count, 2*free + n)
      real(wp) :: rate(lane_count), power(lane_count)
      integer :: i, j

      do j = 1, n
         rate = v_roof
         if (j <= free) rate = y(:, free + j)
         if (j > 1) rate = rate - y(:, free + j - 1)
         call raise_state(factors, coef(1, 3*n + j), y(1, 2*free + j), power)
         !$omp simd
         do i = 1, lane_count
            shear(i, j) = shear(i, j) + coef(i, j)*y(i, 2*free + j)
            y_dot(i, 2*free + j) = hysteretic_rate(coef(i, n + j)*rate(i), coef(i, 2*n + j), &
               power(i))
         end do
      end do
   end subroutine add_smooth_shears

   !> Compute the displacements of the storeys with states, and their rates.
   pure subroutine move_storeys(term, coef, y, motion, d)
      type(term_t), intent(in) :: term
      !! term of `add_floors`
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients of `add_floors`
      real(wp), intent(in) :: y(lane_count, term%n_states)
      !! states of `add_floors`
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(out) :: d(lane_count, term%n, 0:1)
      !! displacements [m] and rates [m/s] of the storeys
      integer :: free, i, j, m

      free = free_floors(term)
      do m = 0, 1
         do j = 1, min(free, term%n)
            !$omp simd
            do i = 1, lane_count
               d(i, j, m) = y(i, m*free + j)
            end do
         end do
      end do
      if (free < term%n) then
         !$omp simd
         do i = 1, lane_count
            d(i, term%n, 0) = coef(i, 1)*(motion%side(i)*motion%u(i))
            d(i, term%n, 1) = coef(i, 1)*(motion%side(i)*motion%j(i)*motion%rate(i))
         end do
         if (motion%is_bent) d(:, term%n, 1) = d(:, term%n, 1) + coef(:, 1)*motion%side &
            *motion%w_rate
      end if
      do m = 0, 1
         do j = term%n, 2, -1
            !$omp simd
            do i = 1, lane_count
               d(i, j, m) = d(i, j, m) - d(i, j - 1, m)
            end do
         end do
      end do
   end subroutine move_storeys

   !> Add the ground force on the excited mass that does not move with the roof (one mode).
   pure subroutine add_excited_mass(coef, motion)
      real(wp), intent(in) :: coef(lane_count)
      !! excited mass minus mass moving with the roof, over m_w [-]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - coef(i)*motion%lever(i)*motion%push(i)
      end do
   end subroutine add_excited_mass

   !> Add the power of this ground force.
   pure subroutine add_excited_mass_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count)
      !! coefficient of `add_excited_mass` [-]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      integer :: i

      !$omp simd
      do i = 1, lane_count
         total(i, of_input) = total(i, of_input) - weight*(coef(i)*motion%push(i)*motion%j(i) &
            *motion%rate(i))
      end do
      if (motion%is_bent) then
         total(:, of_input) = total(:, of_input) - weight*coef*motion%push*motion%w_rate
      end if
   end subroutine add_excited_mass_power

   !> Add the powers of the ground motion on the floors with states, of the frame's dampers, and of
   !> the plastic flow of smooth storeys.
   pure subroutine add_floor_power(term, weight, coef, y, y_dot, motion, total)
      type(term_t), intent(in) :: term
      !! term of `add_floors`
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients of `add_floors`
      real(wp), intent(in) :: y(lane_count, term%n_states)
      !! states of `add_floors`
      real(wp), intent(in) :: y_dot(lane_count, term%n_states)
      !! rates of these states
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: own(lane_count, power_count)
      !! powers of this frame over m_w [W/kg]
      real(wp) :: v(lane_count, 0:term%n)
      !! velocities from the ground to the roof [m/s]
      real(wp) :: force(lane_count)
      !! force of the dampers on a floor [m/s2]
      integer :: n, free
      !! numbers of storeys and of floors with states
      integer :: i, j, k, m

      n = term%n
      free = free_floors(term)
      own = 0
      v(:, 0) = 0
      !$omp simd
      do i = 1, lane_count
         v(i, n) = coef(i, 1)*(motion%side(i)*motion%j(i)*motion%rate(i))
      end do
      if (motion%is_bent) v(:, n) = v(:, n) + coef(:, 1)*motion%side*motion%w_rate
      v(:, 1:free) = y(:, free + 1:2*free)
      do j = 1, n
         force = 0
         do k = 1, n
            !$omp simd
            do i = 1, lane_count
               force(i) = force(i) + coef(i, 3*n + 1 + (j - 1)*n + k)*v(i, k)
            end do
         end do
         !$omp simd
         do i = 1, lane_count
            own(i, of_viscous) = own(i, of_viscous) + force(i)*v(i, j)
         end do
         if (j > free) exit
         !$omp simd
         do i = 1, lane_count
            own(i, of_input) = own(i, of_input) - motion%ground(i)*v(i, j)/coef(i, 2*n + 1 + j)
         end do
      end do
      if (term%law /= no_hysteresis) call add_smooth_power(n, coef(1, 3*n + 2 + n**2), v, &
         y(1, 2*free + 1), y_dot(1, 2*free + 1), own(1, of_plastic))
      do m = 1, power_count
         !$omp simd
         do i = 1, lane_count
            total(i, m) = total(i, m) + weight*(own(i, m)/(coef(i, 1)*coef(i, 1)))
         end do
      end do
   end subroutine add_floor_power

   !> Add the power dissipated by plastic flow of smooth storeys.
   pure subroutine add_smooth_power(n, coef, v, z, z_dot, power)
      integer, intent(in) :: n
      real(wp), intent(in) :: coef(lane_count, 4*n)
      !! coefficients of smooth storeys, see `add_floors`
      real(wp), intent(in) :: v(lane_count, 0:n)
      !! velocities from the ground to the roof [m/s]
      real(wp), intent(in) :: z(lane_count, n)
      !! hysteretic states [-]
      real(wp), intent(in) :: z_dot(lane_count, n)
      !! rates of these states [1/s]
      real(wp), intent(inout) :: power(lane_count)
      !! sum of powers over m_w [W/kg]
      integer :: i, j

      do j = 1, n
         !$omp simd
         do i = 1, lane_count
            power(i) = power(i) + coef(i, j)*z(i, j)*(v(i, j) - v(i, j - 1) &
               - z_dot(i, j)/coef(i, n + j))
         end do
      end do
   end subroutine add_smooth_power

   !> Compute drifts [-] and shears [m/s2] of storeys with states.
   pure subroutine follow_storeys(n, law, unit, over_height, coef, y, roof, found)
      integer, intent(in) :: n
      !! number of storeys and floors
      integer, intent(in) :: law
      !! hysteresis law of the storeys
      real(wp), intent(in) :: unit(lane_count)
      !! reference mass of the floors [-]
      real(wp), intent(in) :: over_height(lane_count, n)
      !! inverse heights of the storeys [1/m]
      real(wp), intent(in) :: coef(lane_count, floor_coefficients(n, n - 1, law))
      !! coefficients of `add_floors`
      real(wp), intent(in) :: y(lane_count, floor_states(n, n - 1, law))
      !! states of the floors
      real(wp), intent(in) :: roof(lane_count)
      !! displacement of the roof [m]
      real(wp), intent(inout) :: found(lane_count, 2*n)
      !! drifts [-], then shears [m/s2]
      real(wp) :: drift(lane_count), shear(lane_count)
      integer :: i, j

      do j = 1, n
         drift = roof
         if (j < n) drift = y(:, j)
         if (j > 1) drift = drift - y(:, j - 1)
         !$omp simd
         do i = 1, lane_count
            shear(i) = coef(i, 1 + j)*drift(i) + coef(i, n + 1 + j)
            found(i, j) = drift(i)*over_height(i, j)
         end do
         if (law /= no_hysteresis) shear = shear + coef(:, 3*n + 1 + n**2 + j)*y(:, 2*n - 2 + j)
         !$omp simd
         do i = 1, lane_count
            found(i, n + j) = shear(i)*unit(i)
         end do
      end do
   end subroutine follow_storeys

end module rwmf_model_effects_storeys_storeys_loop
