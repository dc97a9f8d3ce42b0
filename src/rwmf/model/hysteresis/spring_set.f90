!> Springs with memory in a scene: a tendon that yields or breaks, fuses at the corners, a
!> yielding frame. This module places them, adds their forces to the equation and updates their
!> branches.
!>
!> Their branches are smooth functions of the rotation. The rotation at the end of a branch is
!> computed beforehand (`renew_window`), so that the hybrid loop locates it like an impact.
module rwmf_model_hysteresis_spring_set
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_bilinear_spring, only: is_broken
   use rwmf_model_cable, only: cable_elongation
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, &
      straight_displacement, frame_mass, model_t, place_frame, place_left, place_right, &
      renew_coefficients, sprung_t, window_t
   use rwmf_model_history_row, only: history_row_t, put
   use rwmf_model_hysteresis_spring_laws, only: forget_loss, has_wear, loading_direction, &
      new_branch, pass_limit, spring_energy, spring_force, spring_limits, spring_loss, &
      spring_plastic, spring_residual, turn_spring
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_problem_quantity_table, only: id
   implicit none
   private

   public :: add_springs
   public :: fuses_energy, yielding_energy, springs_loss
   public :: reset_springs, load_to, renew_window, pass_window, turn_back
   public :: moves
   public :: put_spring_forces, tendon_is_broken, prestress_loss, frame_residual
   public :: frame_residuals, plastic_displacement, plastic_parts, uneven_plastic_part
   public :: fuse_uplift, spring_forces

contains

   !> Update the straight lines of the active branches after a branch has changed. Discard
   !> the cached windows of the previous branches.
   subroutine follow_branches(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      if (.not. model%has_bilinear_springs) return
      state%windows%is_known = .false.
      associate (of_frame => model%springs%place == place_frame)
         if (any(of_frame)) then
            state%frame_offset = sum(state%springs%offset, of_frame)
            state%frame_slope = sum(state%springs%slope, of_frame)
         end if
      end associate
      call renew_coefficients(model, state)
   end subroutine follow_branches

   !> Add springs to the scene. Those of the frame come first.
   subroutine add_springs(springs, angle_limit, equation)
      type(sprung_t), intent(in) :: springs(:)
      !! (springs) all of the frame, or none; empty for a tendon, which the cable holds
      real(wp), intent(in) :: angle_limit
      !! largest |theta| of the run [rad]
      type(equation_t), intent(inout) :: equation
      !! equation with its geometry and its cable

      if (.not. allocated(equation%springs)) allocate (equation%springs(0))
      if (any(springs%place == place_frame)) then
         equation%springs = [springs, equation%springs]
      else
         equation%springs = [equation%springs, springs]
      end if
      equation%has_bilinear_springs = .true.
      equation%angle_limit = angle_limit
      if (allocated(equation%reach)) deallocate (equation%reach)
      allocate (equation%reach(2, -1:1, 0:size(equation%springs)))
      equation%reach(:, :, :) = reach_of(equation%model_t)
      call reset_springs(equation%model_t, equation%state)
   end subroutine add_springs

   !> Return whether a spring moves on the current side. A fuse moves when its corner lifts. Under
   !> a hinged wall the left fuse always moves and represents both.
   pure logical function moves(place, side)
      integer, intent(in) :: place
      !! place of the spring: `place_left`, `place_right` or `place_frame`
      integer, intent(in) :: side
      !! current side of the motion, +1 or -1

      moves = place == place_frame .or. place == side
   end function moves

   !> Energy dissipated by yielding of all springs since t = 0 [J/kg].
   real(wp) function springs_loss(equation, theta) result(loss)
      type(equation_t), intent(in) :: equation
      !! equation with springs
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: x
      integer :: i

      loss = 0
      associate (side => equation%state%side)
         if (equation%cable%is_tendon) loss = equation%p%g*spring_loss(equation%cable%tendon, &
            equation%state%tendon, elongation_of(equation, side, 0, side*theta))
         do i = 1, size(equation%springs)
            associate (place => equation%springs(i)%place)
               x = 0
               if (moves(place, side)) x = elongation_of(equation, side, i, side*theta)
               loss = loss + merge(frame_mass(equation), 1.0_wp, place == place_frame) &
                  *spring_loss(equation%springs(i)%spring, equation%state%springs(i), x)
            end associate
         end do
      end associate
   end function springs_loss

   !> Energy stored in the fuses [J/kg].
   real(wp) function fuses_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! states
      real(wp) :: x
      integer :: i

      energy = 0
      do i = 1, size(equation%springs)
         associate (spring => equation%springs(i)%spring, place => equation%springs(i)%place, &
                    branch => equation%state%springs(i))
            if (place == place_frame) cycle
            x = 0
            if (moves(place, equation%state%side)) x = elongation_of(equation, &
               equation%state%side, i, equation%state%side*y(1))
            energy = energy + spring_energy(spring, branch, x)
         end associate
      end do
   end function fuses_energy

   !> Strain energy of the yielding frame minus that of an elastic one; its kinetic part is zero
   !> [J/kg].
   function yielding_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! states
      real(wp) :: energy(2)
      real(wp) :: x
      integer :: i

      energy = 0
      x = straight_displacement(equation, equation%state%side, y(1))
      do i = 1, size(equation%springs)
         associate (spring => equation%springs(i)%spring, place => equation%springs(i)%place, &
                    branch => equation%state%springs(i))
            if (place == place_frame) energy(2) = energy(2) + frame_mass(equation) &
               *(spring_energy(spring, branch, x) - equation%springs(i)%share &
               *(equation%p%omega_s*x)**2/2)
         end associate
      end do
   end function yielding_energy

   !> Elongations of all springs at the ends of the range of rotations in which all are monotone.
   function reach_of(model) result(reach)
      type(model_t), intent(in) :: model
      real(wp) :: reach(2, -1:1, 0:size(model%springs))
      !! elongations by side and spring, see `rotation_at` [m]
      integer :: number
      integer :: side

      reach = 0
      if (.not. model%has_wall) return
      do number = merge(0, 1, model%cable%is_tendon), size(model%springs)
         do side = -1, 1, 2
            reach(1, side, number) = elongation_of(model, side, number, least_angle(model))
            reach(2, side, number) = elongation_of(model, side, number, model%angle_limit)
         end do
      end do
   end function reach_of

   !> Smallest |theta| at which elongations of the springs are computed. For a hinged wall, whose
   !> side never changes, it is the smallest theta [rad].
   pure real(wp) function least_angle(model)
      class(model_t), intent(in) :: model

      least_angle = merge(0.0_wp, -model%angle_limit, model%has_impacts)
   end function least_angle

   !> Reset all springs to their initial branches.
   subroutine reset_springs(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      if (.not. model%has_bilinear_springs) return
      state%tendon = new_branch(model%cable%tendon)
      state%springs = new_branch(model%springs%spring)
      call follow_branches(model, state)
   end subroutine reset_springs

   !> Load springs at rest to an initial rotation, as if it had grown slowly from zero.
   subroutine load_to(model, state, theta)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      if (.not. model%has_bilinear_springs) return
      do
         call renew_window(model, state)
         if (theta > state%high) then
            call pass_window(model, state, is_rising=.true.)
         else if (theta < state%low) then
            call pass_window(model, state, is_rising=.false.)
         else
            exit
         end if
      end do
      ! springs that have yielded during this loading may unload from here on
      call turn_back(model, state, theta)
      call renew_window(model, state)
      call forget_loss(state%tendon)
      call forget_loss(state%springs)
   end subroutine load_to

   !> Set the range of rotations in which the active branches are valid on the current side.
   subroutine renew_window(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      if (.not. model%has_bilinear_springs) return
      associate (window => state%windows(state%side))
         if (.not. window%is_known) window = window_of(model, state)
         state%low = window%low
         state%high = window%high
         state%ends_at_peak = window%ends_at_peak
      end associate
   end subroutine renew_window

   !> Compute this range from the limits of the springs.
   type(window_t) function window_of(model, state) result(window)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer :: i

      window%is_known = .true.
      window%ends_at_peak = model%has_loading_direction .or. model%creep > 0
      if (model%cable%is_tendon) call narrow_window(model, state%side, 0, model%cable%tendon, &
         state%tendon, window)
      do i = 1, size(model%springs)
         if (moves(model%springs(i)%place, state%side)) call narrow_window(model, state%side, &
            i, model%springs(i)%spring, state%springs(i), window)
      end do
   end function window_of

   !> Narrow a window to the limits of one spring.
   subroutine narrow_window(model, side, number, spring, branch, window)
      type(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      integer, intent(in) :: number
      !! number of the spring; 0 is the tendon
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      type(window_t), intent(inout) :: window
      real(wp) :: x(2)
      !! limits of the elongation [m]
      real(wp) :: theta(2)

      if (loading_direction(spring, branch) /= 0) window%ends_at_peak = .true.
      call spring_limits(spring, branch, x(1), x(2))
      theta = [rotation_at(model, side, number, x(1)), rotation_at(model, side, number, x(2))]
      window%low = max(window%low, minval(theta))
      window%high = min(window%high, maxval(theta))
   end subroutine narrow_window

   !> Elongation of a spring at a rotation on the current side [m].
   real(wp) function elongation_of(model, side, number, phi) result(x)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      integer, intent(in) :: number
      !! number of the spring; 0 is the tendon
      real(wp), intent(in) :: phi
      !! |theta| [rad]; bare frame: displacement [m]
      real(wp) :: arm

      if (number == 0) then
         call cable_elongation(model%cable, phi, x, arm)
      else if (model%springs(number)%place == place_frame) then
         x = straight_displacement(model, side, side*phi)
      else
         x = 4*model%p%R*model%p%sin_alpha*sin(phi/2)
      end if
   end function elongation_of

   !> Rotation (bare frame: displacement) at which a spring has the elongation x. It is +-huge
   !> outside the range up to overturning, in which all elongations are monotone.
   real(wp) function rotation_at(model, side, number, x) result(theta)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      integer, intent(in) :: number
      !! number of the spring; 0 is the tendon
      real(wp), intent(in) :: x
      !! elongation [m]
      type(bracket_t) :: bracket
      !! bracket of |theta|
      integer :: direction
      !! +1 if the elongation grows with |theta|

      theta = x
      if (.not. model%has_wall .and. number > 0) return
      associate (reach => model%reach(:, side, number))
         direction = merge(1, -1, reach(2) > reach(1))
         theta = direction*side*huge(x)
         if (x >= max(reach(1), reach(2))) return
         theta = -theta
         if (x <= min(reach(1), reach(2))) return
      end associate
      theta = side*angle_of(model, side, number, x)
      if (abs(theta) < huge(x)) return
      bracket = bracket_between(least_angle(model), model%angle_limit)
      do while (bracket%is_open)
         call narrow(bracket, direction*(elongation_of(model, side, number, bracket%middle) &
            - x) >= 0)
      end do
      theta = side*bracket%high
   end function rotation_at

   !> |theta| at which a spring reaches an elongation, if a closed formula exists; else the largest
   !> number. A straight cable and the far end of a tilted link have no formula.
   pure real(wp) function angle_of(model, side, number, x) result(angle)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      integer, intent(in) :: number
      !! number of the spring; 0 is the tendon
      real(wp), intent(in) :: x
      !! elongation [m]
      real(wp) :: away
      !! displacement from the pivot over 2R [-]
      real(wp) :: cosine
      !! cosine of alpha - phi

      angle = huge(angle)
      associate (R => model%p%R, shape => model%geometry)
         if (number == 0) then
            if (.not. model%cable%is_straight) angle = x/model%cable%b
         else if (model%springs(number)%place /= place_frame) then
            angle = 2*asin(x/(4*R*model%p%sin_alpha))
         else if (.not. shape%link > 0) then
            away = side*x/(2*R)
            if (shape%sine_link(side) > 0) then
               ! a difference of sines, which keeps all digits of a small rotation
               associate (s => model%p%sin_alpha, c => model%p%cos_alpha)
                  cosine = sqrt(c**2 + away*(2*s - away))
                  angle = atan2(s*(away*(2*s - away)/(cosine + c)) + c*away, c*cosine &
                     + s*(s - away))
               end associate
            else
               angle = asin(away/model%p%cos_alpha)
            end if
         end if
      end associate
   end function angle_of

   !> Begin the next branch of each spring that has its limit at the end of the window.
   subroutine pass_window(model, state, is_rising)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      logical, intent(in) :: is_rising
      !! theta grows
      real(wp) :: limit
      integer :: number

      limit = merge(state%high, state%low, is_rising)
      do number = 0, size(model%springs)
         if (number == 0) then
            if (model%cable%is_tendon) call pass_one(model, state%side, number, limit, is_rising, &
               model%cable%tendon, state%tendon)
         else if (moves(model%springs(number)%place, state%side)) then
            call pass_one(model, state%side, number, limit, is_rising, &
               model%springs(number)%spring, state%springs(number))
         end if
      end do
      call follow_branches(model, state)
      call renew_window(model, state)
   end subroutine pass_window

   !> Begin the next branch of one spring if its limit is at this rotation.
   subroutine pass_one(model, side, number, limit, is_rising, spring, branch)
      type(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      integer, intent(in) :: number
      real(wp), intent(in) :: limit
      !! limit of the rotation or displacement [rad] or [m]
      logical, intent(in) :: is_rising
      !! theta grows
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp) :: x(2)
      logical :: grows
      !! true if the elongation grows

      call spring_limits(spring, branch, x(1), x(2))
      grows = is_rising .eqv. side > 0
      if (number > 0) then
         if (model%springs(number)%place == place_frame) grows = is_rising
      end if
      if (abs(rotation_at(model, side, number, merge(x(2), x(1), grows)) - limit) <= 0) then
         call pass_limit(spring, branch, grows)
      end if
   end subroutine pass_one

   !> Unload yielding springs where the motion reverses or the wall hits the base.
   !>
   !> A frame that the wall carries through its position at rest does not reverse. If its law has
   !> wear, its branch continues.
   subroutine turn_back(model, state, theta, goes_on, onward)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      logical, intent(in), optional :: goes_on
      !! true if the wall hits the base and theta' keeps its sign; default false
      integer, intent(in), optional :: onward
      !! sign of theta' after the event; springs that continue loading are unchanged. Default: all
      !! unload
      logical :: unloads, passes
      integer :: of_frame, of_corner
      !! directions of continued loading, of the frame and of elongations at the wall
      integer :: i

      if (.not. (model%has_bilinear_springs .and. state%ends_at_peak)) return
      passes = .false.
      if (present(goes_on)) passes = goes_on
      of_frame = 0
      if (present(onward)) of_frame = onward
      of_corner = of_frame*state%side
      associate (direction => loading_direction(model%cable%tendon, state%tendon))
         unloads = direction /= 0 .and. direction /= of_corner
      end associate
      if (unloads) call turn_spring(model%cable%tendon, state%tendon, &
         elongation_of(model, state%side, 0, state%side*theta))
      do i = 1, size(model%springs)
         associate (spring => model%springs(i)%spring, place => model%springs(i)%place)
            if (any(loading_direction(spring, state%springs(i)) == [0, merge(of_frame, of_corner, &
               place == place_frame)])) cycle
            if (.not. moves(place, state%side)) cycle
            if (passes .and. place == place_frame .and. has_wear(spring)) cycle
            call turn_spring(spring, state%springs(i), elongation_of(model, state%side, i, &
               state%side*theta))
         end associate
         unloads = .true.
      end do
      if (unloads) call follow_branches(model, state)
   end subroutine turn_back

   !> Write the history columns of the frame's total spring force and the forces of the fuses.
   subroutine put_spring_forces(row, equation, theta)
      type(history_row_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      !! equation with springs
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: forces(size(equation%springs))
      integer :: i

      forces = spring_forces(equation, theta)
      associate (of_frame => equation%springs%place == place_frame)
         if (any(of_frame)) call put(row, id%frame_force_over_m_s_g, sum(forces, of_frame))
      end associate
      do i = 1, size(forces)
         select case (equation%springs(i)%place)
         case (place_left)
            call put(row, id%fuse_left_force_over_m_w_g, forces(i))
         case (place_right)
            call put(row, id%fuse_right_force_over_m_w_g, forces(i))
         case default
            ! springs of the frame, written above
         end select
      end do
   end subroutine put_spring_forces

   !> Forces of frame springs and fuses, over the weight of m_s and of m_w [-].
   function spring_forces(equation, theta) result(forces)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: forces(size(equation%springs))
      real(wp) :: x
      integer :: i

      do i = 1, size(forces)
         x = 0
         if (moves(equation%springs(i)%place, equation%state%side)) then
            x = elongation_of(equation, equation%state%side, i, equation%state%side*theta)
         end if
         forces(i) = spring_force(equation%springs(i)%spring, equation%state%springs(i), x) &
            /equation%p%g
      end do
      ! under a hinged wall the right fuse, which comes last, mirrors the left one
      i = size(forces)
      if (.not. equation%has_impacts .and. i > 1) then
         if (equation%springs(i)%place == place_right) forces(i) = -forces(i - 1)
      end if
   end function spring_forces

   !> Upward force of both fuses on a rocking wall, over m_w g [-].
   real(wp) function fuse_uplift(equation, theta) result(push)
      type(equation_t), intent(in) :: equation
      !! equation with fuses
      real(wp), intent(in) :: theta
      !! current rotation [rad]
      real(wp) :: forces(size(equation%springs))

      ! the fuses come last
      forces = spring_forces(equation, theta)
      push = -sum(forces(size(forces) - 1:))
   end function fuse_uplift

   !> Return whether the tendon has broken.
   pure logical function tendon_is_broken(equation)
      type(equation_t), intent(in) :: equation

      tendon_is_broken = equation%cable%is_tendon .and. is_broken(equation%state%tendon)
   end function tendon_is_broken

   !> Loss of the tendon force at theta = 0, over m_w g [-].
   real(wp) function prestress_loss(equation, theta) result(loss)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! current rotation [rad]
      type(branch_t) :: unloaded

      unloaded = equation%state%tendon
      call turn_spring(equation%cable%tendon, unloaded, elongation_of(equation, &
         equation%state%side, 0, equation%state%side*theta))
      loss = equation%cable%eta_0 - max(0.0_wp, unloaded%offset)
   end function prestress_loss

   !> Plastic part of the frame's displacement, by which its force lags behind an elastic one [m].
   real(wp) function plastic_displacement(equation, theta) result(plastic)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      plastic = 0
      if (.not. allocated(equation%springs)) return
      associate (parts => plastic_parts(equation, theta))
         plastic = sum(equation%springs(:size(parts))%share*parts)
      end associate
   end function plastic_displacement

   !> Plastic displacement minus that implied by the lowest storey, as a displacement of the roof.
   !> It is not zero where storeys yield one by one [m].
   real(wp) function uneven_plastic_part(equation, theta) result(plastic)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      plastic = 0
      if (.not. allocated(equation%springs)) return
      associate (parts => plastic_parts(equation, theta))
         if (size(parts) > 0) plastic = plastic_displacement(equation, theta) - parts(1)
      end associate
   end function uneven_plastic_part

   !> Displacement of zero frame force after slow unloading [m].
   real(wp) function frame_residual(equation, theta) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      residual = 0
      if (.not. allocated(equation%springs)) return
      associate (residuals => frame_residuals(equation, theta))
         residual = sum(equation%springs(:size(residuals))%share*residuals)
      end associate
   end function frame_residual

   !> Displacement of zero force after slow unloading, of each spring of the frame [m].
   function frame_residuals(equation, theta) result(residuals)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: residuals(count(equation%springs%place == place_frame))
      !! (springs of the frame, which come first)

      associate (n => size(residuals), state => equation%state)
         residuals = spring_residual(equation%springs(:n)%spring, state%springs(:n), &
            straight_displacement(equation, state%side, theta))
      end associate
   end function frame_residuals

   !> Plastic part of the displacement in each spring of the frame [m].
   function plastic_parts(equation, theta) result(parts)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: parts(count(equation%springs%place == place_frame))
      !! (springs of the frame, which come first)

      associate (n => size(parts), state => equation%state)
         parts = spring_plastic(equation%springs(:n)%spring, state%springs(:n), &
            straight_displacement(equation, state%side, theta))
      end associate
   end function plastic_parts

end module rwmf_model_hysteresis_spring_set
