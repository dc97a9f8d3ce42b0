!> Loop over lanes that computes the reactions.
!>
!> Each loop of a scene adds to the moment about the pivot, and the arms of these moments are known.
!> The moments of the loops in `force_parts_t` thus give their forces on the wall
!> (docs/theory/demands.md, "Reactions").
module rwmf_model_system_reactions_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_effects_numbers, only: fuse_effect, link_effect, storeys_effect
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   use rwmf_model_scene, only: first_wall, force_parts_t, frame_term, scene_t, &
      straight_cable_term
   implicit none
   private

   public :: lane_reactions, lane_forces, lane_forces_t, push_corner
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
         call press_corner(parts%under_corner, coef, corner, motion, phi_ddot, force)
         call pull_cable(parts%in_cable, coef, cable, motion, force, forces%cable)
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

   !> Compute the force of the corner devices on the wall. The angular acceleration is that of phi =
   !> |theta|.
   subroutine push_corner(part, coef, y, phi_ddot, force)
      type(scene_t), intent(in) :: part
      !! loops of the corner devices
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      !! coefficients of the loops, on the current side and the active branches
      real(wp), intent(in) :: y(lane_count, part%n)
      !! (states)
      real(wp), intent(in) :: phi_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(out) :: force(lane_count, 2)
      !! force over m_w, horizontal (positive as u_g'') and upward [m/s2]
      type(lane_motion_t) :: motion
      real(wp) :: corner(lane_count, 2), rates(lane_count, part%n)

      motion%ground = 0
      motion%upward = 0
      call add_up(part, coef, y, motion, corner, rates)
      force = 0
      call press_corner(part, coef, corner, motion, phi_ddot, force)
      force = -force
   end subroutine push_corner

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

   !> Subtract the forces of the corner devices from the force of the foundation. The devices act
   !> along the chord of the lifting corner, with the arm 2b cos(phi/2). The fuse under the other
   !> corner adds its force.
   pure subroutine press_corner(part, coef, corner, motion, phi_ddot, force)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      real(wp), intent(in) :: corner(lane_count, 2)
      !! moment and inertia of that part
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(in) :: phi_ddot(lane_count)
      !! [rad/s2]
      real(wp), intent(inout) :: force(lane_count, 2)
      !! force of the foundation [m/s2]
      real(wp) :: along
      !! force on the wall [m/s2]
      integer :: i, j

      if (size(part%terms) == 0) return
      !$omp simd private(along)
      do i = 1, lane_count
         along = (corner(i, 1) - corner(i, 2)*phi_ddot(i))/(2*coef(i, first_wall + 1) &
            *coef(i, first_wall + 3)*motion%half_cosine(i))
         force(i, 1) = force(i, 1) - along*motion%side(i)*motion%half_sine(i)
         force(i, 2) = force(i, 2) - along*motion%half_cosine(i)
      end do
      do j = 1, size(part%terms)
         if (part%terms(j)%effect /= fuse_effect) cycle
         associate (at_pivot => part%terms(j)%coef + 2)
            !$omp simd
            do i = 1, lane_count
               force(i, 2) = force(i, 2) + coef(i, at_pivot)
            end do
         end associate
      end do
   end subroutine press_corner

   !> Compute the cable force on the wall and subtract it from the force of the foundation. It acts
   !> along a straight cable, otherwise along the axis of the wall.
   pure subroutine pull_cable(part, coef, cable, motion, force, on_wall)
      type(scene_t), intent(in) :: part
      real(wp), intent(in) :: coef(lane_count, part%n_coef)
      real(wp), intent(in) :: cable(lane_count, 2)
      !! moment of that part
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: force(lane_count, 2)
      !! force of the foundation [m/s2]
      real(wp), intent(inout) :: on_wall(lane_count, 2)
      !! force of the cable [m/s2]
      real(wp) :: s, c, pull, sine, cosine, rise
      integer :: i

      if (size(part%terms) == 0) return
      if (part%terms(1)%effect == straight_cable_term) then
         !$omp simd private(s, c, pull, sine, rise)
         do i = 1, lane_count
            s = coef(i, first_wall + 3)
            c = coef(i, first_wall + 2)
            sine = 2*motion%half_sine(i)*motion%half_cosine(i)
            rise = 2*c*(1 - 2*motion%half_sine(i)*motion%half_sine(i)) + s*sine
            pull = cable(i, 1)/(coef(i, first_wall + 1)*s)
            on_wall(i, 1) = pull*motion%side(i)*(2*s*motion%half_sine(i) &
               *motion%half_sine(i) + 2*c*sine)/rise
            on_wall(i, 2) = pull
         end do
      else
         !$omp simd private(pull, sine, cosine)
         do i = 1, lane_count
            sine = 2*motion%half_sine(i)*motion%half_cosine(i)
            cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
            pull = cable(i, 1)/(coef(i, first_wall + 1)*coef(i, first_wall + 3))
            on_wall(i, 1) = pull*motion%side(i)*sine
            on_wall(i, 2) = pull*cosine
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
