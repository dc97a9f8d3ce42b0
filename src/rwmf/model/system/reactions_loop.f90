!> Loop over lanes that computes the reactions.
!>
!> Each loop of a scene adds to the moment about the pivot, and the arms of these moments are known.
!> The moments of the loops in `force_parts_t` thus give their forces on the wall
!> (docs/theory/demands.md, "Reactions").
module rwmf_model_system_reactions_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_effects_nl_damper_loop, only: raise_rate
   use rwmf_model_effects_numbers, only: inerter_effect, link_effect, nl_damper_effect, &
      storeys_effect
   use rwmf_model_lanes, only: lane_count, lane_motion_t, line_coefficients
   use rwmf_model_scene, only: axis_term, chord_term, first_wall, force_parts_t, frame_term, scene_t
   implicit none
   private

   public :: lane_reactions, lane_forces, lane_forces_t, inerter_force
   public :: low_normal, demand, shear, reaction_count

   integer, parameter :: low_normal = 1
   integer, parameter :: demand = 2
   integer, parameter :: shear = 3
   integer, parameter :: reaction_count = 3
   !! -N [m/s2], H/N [-] (with a shear key H [m/s2]) and V [m/s2]. The run keeps the maximum of the
   !! first and of the magnitudes of the others.

   !> Motion of the lanes, and the forces on their walls above the base, horizontal and upward, over
   !> m_w [m/s2].
   type :: lane_forces_t
      type(lane_motion_t) :: motion
      real(wp) :: phi_ddot(lane_count)
      !! angular acceleration [rad/s2]; without a wall u'' [m/s2]
      real(wp) :: link(lane_count, 2)
      real(wp) :: cable(lane_count, 2)
   end type lane_forces_t

contains

   !> Compute the reactions of moving lanes.
   subroutine lane_reactions(parts, coef, y, ground, found)
      type(force_parts_t), intent(in) :: parts
      !! complete
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, on the current side and the active branches
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! horizontal and vertical ground acceleration [m/s2]
      real(wp), intent(out) :: found(lane_count, reaction_count)
      !! reactions as in `lane_forces` [m/s2], [-]
      type(lane_forces_t) :: forces
      real(wp) :: rates(lane_count, parts%through_link%n)

      call lane_forces(parts, coef, y, ground, found, forces, rates)
   end subroutine lane_reactions

   !> Compute the reactions, and the motion and forces that cause them.
   subroutine lane_forces(parts, coef, y, ground, found, forces, rates)
      type(force_parts_t), intent(in) :: parts
      !! complete
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, on the current side and the active branches
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! horizontal and vertical ground acceleration [m/s2]
      real(wp), intent(out) :: found(lane_count, reaction_count)
      !! -N [m/s2], H/N [-] (with a shear key H [m/s2]) and V [m/s2], in the columns `low_normal`,
      !! `demand` and `shear`. Without a wall only the shear is meaningful; the first column holds
      !! the smallest number, the second 0.
      type(lane_forces_t), intent(out) :: forces
      real(wp), intent(out) :: rates(lane_count, parts%through_link%n)
      !! rates of the floor states [m/s], [m/s2]; other rates are undefined
      real(wp), dimension(lane_count, 2) :: link, corner, cable
      !! moment and inertia of the parts, over m_w R**2 [1/s2], [-]
      real(wp) :: force(lane_count, 2)
      !! force of the foundation on the wall, horizontal and upward [m/s2]
      integer :: i

      associate (motion => forces%motion, phi_ddot => forces%phi_ddot)
         motion%ground = ground(:, 1)
         motion%upward = ground(:, 2)
         corner = 0
         cable = 0
         if (size(parts%under_corner%terms) > 0) call add_up(parts%under_corner, coef, y, motion, &
            corner, rates)
         if (size(parts%in_cable%terms) > 0) call add_up(parts%in_cable, coef, y, motion, cable, &
            rates)
         call add_up(parts%through_link, coef, y, motion, link, rates)
         forces%link = 0
         forces%cable = 0
         if (.not. parts%through_link%has_wall) then
            !$omp simd
            do i = 1, lane_count
               found(i, low_normal) = -huge(1.0_wp)
               found(i, demand) = 0
               phi_ddot(i) = link(i, 1)/link(i, 2)
               found(i, shear) = phi_ddot(i) + ground(i, 1)
            end do
            call push_floors(parts%through_link, coef, rates, ground, found(1, shear))
            return
         end if
         call move_centroid(coef, ground, link + corner + cable, motion, phi_ddot, force)
         call push_frame(parts%through_link, coef, link, motion, phi_ddot, found(1, shear), force, &
            forces%link)
         call push_floors(parts%through_link, coef, rates, ground, found(1, shear))
         call press_base(parts%under_corner, coef, motion, phi_ddot, force)
         call pull_cable(parts%in_cable, coef, motion, force, forces%cable)
      end associate
      !$omp simd
      do i = 1, lane_count
         found(i, low_normal) = -force(i, 2)
      end do
      if (parts%has_shear_key) then
         found(:, demand) = force(:, 1)
         return
      end if
      !$omp simd
      do i = 1, lane_count
         found(i, demand) = merge(force(i, 1)/max(force(i, 2), tiny(1.0_wp)), sign(huge(1.0_wp), &
            force(i, 1)), abs(force(i, 1)) < force(i, 2)*sqrt(huge(1.0_wp)))
      end do
   end subroutine lane_forces

   !> Force of the inerters along the chord of the lifting corner on the wall, downward at phi = 0
   !> [m/s2].
   pure real(wp) function inerter_force(coef, R, sin_alpha, phi, rate, phi_ddot) result(force)
      real(wp), intent(in) :: coef
      !! coefficient of `add_inerter` [-]
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp), intent(in) :: sin_alpha
      !! sine of the slenderness [-]
      real(wp), intent(in) :: phi, rate, phi_ddot
      !! |theta| [rad], its first [rad/s] and second rate [rad/s2]

      force = coef*R/(2*sin_alpha)*(cos(phi/2)*phi_ddot - 0.5_wp*sin(phi/2)*rate**2)
   end function inerter_force

   !> Compute the moment and inertia that the loops of a part add to those of the wall.
   subroutine add_up(part, coef, y, motion, total, rates)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      real(wp), intent(in) :: y(lane_count, part%n)
      !! (states)
      type(lane_motion_t), intent(inout) :: motion
      !! on input the ground accelerations; on return also the kinematics
      real(wp), intent(out) :: total(lane_count, 2)
      !! moment [1/s2] and inertia [-] over m_w R**2
      real(wp), intent(inout) :: rates(lane_count, part%n)
      !! rates of states in the loops of the part
      integer :: i

      call lane_rates(part, coef, y, motion, rates)
      !$omp simd
      do i = 1, lane_count
         total(i, 1) = motion%moment(i)
         total(i, 2) = motion%inertia(i)
      end do
      if (.not. part%has_wall) return
      associate (inertia => coef(:, first_wall + 6), g_over_R => coef(:, first_wall + 7))
         !$omp simd
         do i = 1, lane_count
            total(i, 1) = total(i, 1) + (g_over_R(i)*motion%s(i) + motion%c(i)*motion%push(i))
            total(i, 2) = total(i, 2) - inertia(i)
         end do
      end associate
   end subroutine add_up

   !> Compute the angular acceleration, and the force in addition to the weight that accelerates the
   !> wall's centroid.
   pure subroutine move_centroid(coef, ground, total, motion, phi_ddot, force)
      real(wp), intent(in) :: coef(lane_count, first_wall + 7)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! [m/s2]
      real(wp), intent(in) :: total(lane_count, 2)
      !! moment and inertia of all parts
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(out) :: phi_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(out) :: force(lane_count, 2)
      !! over m_w [m/s2]
      real(wp) :: R, g, square
      integer :: i

      !$omp simd private(R, g, square)
      do i = 1, lane_count
         R = 1/coef(i, first_wall + 1)
         g = R*coef(i, first_wall + 7) + ground(i, 2)
         square = motion%rate(i)*motion%rate(i)
         ! the angular acceleration of a held wall is zero
         phi_ddot(i) = coef(i, 1)*((total(i, 1) - (g/R*motion%s(i) + motion%c(i)*motion%push(i))) &
            /(total(i, 2) + coef(i, first_wall + 6)))
         force(i, 1) = R*motion%side(i)*(motion%c(i)*phi_ddot(i) + motion%s(i)*square) &
            + ground(i, 1)
         force(i, 2) = R*(motion%s(i)*phi_ddot(i) - motion%c(i)*square) + g
      end do
   end subroutine move_centroid

   !> Subtract the forces of the devices under the base from the force of the foundation. They act
   !> along the chord of the point that they hold.
   pure subroutine press_base(part, coef, motion, phi_ddot, force)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(in) :: phi_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(inout) :: force(lane_count, 2)
      !! force of the foundation [m/s2]
      real(wp) :: along(lane_count)
      !! force against the motion [m/s2]
      integer :: i, j

      do j = 1, size(part%terms)
         associate (own => part%terms(j)%coef)
            select case (part%terms(j)%effect)
            case (chord_term)
               !$omp simd
               do i = 1, lane_count
                  along(i) = coef(i, own + 3) + coef(i, own + 4)*motion%half_sine(i) &
                     + coef(i, own + 5)*motion%half_cosine(i)*motion%rate(i)
                  force(i, 2) = force(i, 2) + coef(i, own + 6)
               end do
            case (nl_damper_effect)
               call raise_rate(coef(1, own), motion, along)
               along = coef(:, own + 3)*sign(along, motion%rate)
            case (inerter_effect)
               !$omp simd
               do i = 1, lane_count
                  along(i) = coef(i, own)/(2*coef(i, first_wall + 1)*coef(i, first_wall + 3)) &
                     *(motion%half_cosine(i)*phi_ddot(i) - 0.5_wp*motion%half_sine(i) &
                     *motion%rate(i)*motion%rate(i))
               end do
            case default
               along = 0
            end select
         end associate
         !$omp simd
         do i = 1, lane_count
            force(i, 1) = force(i, 1) + along(i)*motion%side(i)*motion%half_sine(i)
            force(i, 2) = force(i, 2) + along(i)*motion%half_cosine(i)
         end do
      end do
   end subroutine press_base

   !> Compute the force of the tendons on the wall and subtract it from the force of the foundation.
   !> It acts along straight tendons, otherwise along the axis of the wall.
   pure subroutine pull_cable(part, coef, motion, force, on_wall)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: force(lane_count, 2)
      !! force of the foundation [m/s2]
      real(wp), intent(inout) :: on_wall(lane_count, 2)
      !! force of the cable [m/s2]
      real(wp) :: pull, sine, versine, rise, length
      integer :: i, k, own

      if (size(part%terms) == 0) return
      own = part%terms(1)%coef
      if (part%terms(1)%effect == axis_term) then
         !$omp simd private(pull, sine, versine)
         do i = 1, lane_count
            sine = 2*motion%half_sine(i)*motion%half_cosine(i)
            versine = 2*motion%half_sine(i)*motion%half_sine(i)
            pull = coef(i, own + 2) + coef(i, own + 3)*motion%phi(i)
            on_wall(i, 1) = -pull*motion%side(i)*sine
            on_wall(i, 2) = -pull*(1 - versine)
         end do
      else
         do k = 1, part%terms(1)%n
            !$omp simd private(pull, sine, versine, rise, length)
            do i = 1, lane_count
               associate (z => coef(i, own + 2), a => coef(i, own + 3), &
                  inverse => coef(i, first_wall + 1))
                  sine = 2*motion%half_sine(i)*motion%half_cosine(i)
                  versine = 2*motion%half_sine(i)*motion%half_sine(i)
                  rise = 2*a*(a*versine + z*sine)
                  length = sqrt(z*z + rise)
                  pull = (coef(i, own) + coef(i, own + 1)*(rise/(length + z)))/(inverse*inverse &
                     *length)
                  on_wall(i, 1) = on_wall(i, 1) - pull*motion%side(i)*(z*sine + a*versine)
                  on_wall(i, 2) = on_wall(i, 2) - pull*(z*(1 - versine) + a*sine)
               end associate
            end do
            own = own + line_coefficients
         end do
      end if
      !$omp simd
      do i = 1, lane_count
         force(i, 1) = force(i, 1) - on_wall(i, 1)
         force(i, 2) = force(i, 2) - on_wall(i, 2)
      end do
   end subroutine pull_cable

   !> Compute the force of the frame on the wall, through a link that may be tilted, and its part of
   !> the base shear.
   pure subroutine push_frame(part, coef, link, motion, phi_ddot, base, force, along)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      real(wp), intent(in) :: link(lane_count, 2)
      !! moment and inertia of that part
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(in) :: phi_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(out) :: base(lane_count)
      !! shear of wall and frame together [m/s2]
      real(wp), intent(inout) :: force(lane_count, 2)
      !! force of the foundation; on input with the horizontal force that accelerates the wall
      !! [m/s2]
      real(wp), intent(inout) :: along(lane_count, 2)
      !! force of the link on the wall [m/s2]
      real(wp) :: R, v
      integer :: i, j

      !$omp simd private(R)
      do i = 1, lane_count
         R = 1/coef(i, first_wall + 1)
         along(i, 1) = R*motion%side(i)*(link(i, 1) - link(i, 2)*phi_ddot(i))/motion%lever(i)
         base(i) = force(i, 1)
         force(i, 1) = force(i, 1) - along(i, 1)
      end do
      do j = 1, size(part%terms)
         associate (own => part%terms(j)%coef)
            if (part%terms(j)%effect == frame_term) then
               !$omp simd private(R)
               do i = 1, lane_count
                  R = 1/coef(i, first_wall + 1)
                  base(i) = base(i) + coef(i, own)*(R*motion%side(i)*(motion%k(i)*motion%rate(i) &
                     *motion%rate(i) + motion%j(i)*phi_ddot(i)) + motion%ground(i))
               end do
            else if (part%terms(j)%effect == link_effect) then
               !$omp simd private(v)
               do i = 1, lane_count
                  v = motion%half_sine(i)*(coef(i, own + 3)*motion%half_cosine(i) &
                     - coef(i, own + 2)*motion%half_sine(i))
                  along(i, 2) = motion%side(i)*coef(i, own + 1)*along(i, 1)*v &
                     /sqrt(max(coef(i, own)*coef(i, own) - v*v, 0.0_wp))
                  force(i, 2) = force(i, 2) - along(i, 2)
               end do
            end if
         end associate
      end do
   end subroutine push_frame

   !> Add the floors below the roof to the base shear.
   pure subroutine push_floors(part, coef, rates, ground, base)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      real(wp), intent(in) :: rates(lane_count, part%n)
      !! rates of the states
      real(wp), intent(in) :: ground(lane_count)
      !! [m/s2]
      real(wp), intent(inout) :: base(lane_count)
      !! shear of wall and frame together [m/s2]
      integer :: i, j, k

      do k = 1, size(part%terms)
         if (part%terms(k)%effect /= storeys_effect) cycle
         associate (n => part%terms(k)%n, own => part%terms(k)%coef, first => part%terms(k)%state)
            do j = 1, n - 1
               !$omp simd
               do i = 1, lane_count
                  base(i) = base(i) + (rates(i, first + n - 2 + j) + ground(i)) &
                     /coef(i, own + 2*n + j)
               end do
            end do
         end associate
      end do
   end subroutine push_floors

end module rwmf_model_system_reactions_loop
