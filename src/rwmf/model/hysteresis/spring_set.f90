!> Springs with memory in a scene: those of a yielding frame, and of tendons, fuses, couplings and
!> restraints. This module updates their branches and evaluates them.
!>
!> Their branches are smooth functions of the rotation. The rotation at the end of a branch is
!> computed beforehand (`renew_window`), so that the hybrid loop locates it like an impact. A window
!> also ends where the stroke of a vertical element turns.
module rwmf_model_hysteresis_spring_set
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_bilinear_spring, only: is_broken
   use rwmf_model_elements, only: element_t, of_cable
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, &
      straight_displacement, frame_mass, model_t, renew_coefficients, sprung_t, window_t
   use rwmf_model_hysteresis_spring_laws, only: forget_loss, has_wear, loading_direction, &
      new_branch, pass_limit, spring_energy, spring_force, spring_limits, spring_loss, &
      spring_plastic, spring_residual, turn_spring
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_model_stroke, only: angle_of_stroke, moves, stroke_at, turning_angle
   implicit none
   private

   public :: add_springs
   public :: elements_energy, yielding_energy, springs_loss
   public :: reset_springs, load_to, renew_window, pass_window, turn_back
   public :: broken_tendons, prestress_loss, frame_residual, frame_force
   public :: frame_residuals, plastic_displacement, plastic_parts, uneven_plastic_part

contains

   !> Update the straight lines of the active branches after a branch has changed. Discard
   !> the cached windows of the previous branches.
   subroutine follow_branches(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state

      if (.not. model%has_bilinear_springs) return
      state%windows%is_known = .false.
      associate (of_frame => model%springs%element == 0)
         if (any(of_frame)) then
            state%frame_offset = sum(state%springs%offset, of_frame)
            state%frame_slope = sum(state%springs%slope, of_frame)
         end if
      end associate
      call renew_coefficients(model, state)
   end subroutine follow_branches

   !> Add springs with memory to the scene, those of the frame first.
   subroutine add_springs(springs, angle_limit, equation)
      type(sprung_t), intent(in) :: springs(:)
      real(wp), intent(in) :: angle_limit
      !! largest |theta| of the run [rad]
      type(equation_t), intent(inout) :: equation
      real(wp) :: angle, turn
      integer :: i, side

      if (.not. allocated(equation%springs)) allocate (equation%springs(0))
      equation%springs = [equation%springs, springs]
      equation%has_bilinear_springs = .true.
      equation%angle_limit = angle_limit
      angle = huge(angle)
      do i = 1, size(equation%springs)
         if (equation%springs(i)%element == 0) cycle
         associate (stroke => equation%elements(equation%springs(i)%element)%stroke)
            do side = -1, 1, 2
               turn = min(turning_angle(stroke, side), angle_limit)
               angle = min(angle, turn)
               equation%springs(i)%ends(:, side) = [stroke_at(stroke, side, turn), &
                  stroke_at(stroke, side, angle_limit)]
            end do
         end associate
      end do
      if (angle < angle_limit) equation%state%is_beyond = spread(.false., 1, size(equation%springs))
      call reset_springs(equation%model_t, equation%state)
   end subroutine add_springs

   !> Number of walls' masses, or of the frame's mass, that a spring acts on for each m_w [-].
   pure real(wp) function weight_of(model, number) result(weight)
      class(model_t), intent(in) :: model
      integer, intent(in) :: number
      !! number of the spring

      associate (element => model%springs(number)%element)
         if (element == 0) then
            weight = frame_mass(model)
         else
            weight = model%elements(element)%weight
         end if
      end associate
   end function weight_of

   !> Energy dissipated by yielding of all springs since t = 0 [J/kg].
   real(wp) function springs_loss(equation, theta) result(loss)
      type(equation_t), intent(in) :: equation
      !! equation with springs
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: x
      integer :: i

      loss = 0
      do i = 1, size(equation%springs)
         x = elongation_of(equation, equation%state%side, i, equation%state%side*theta)
         loss = loss + weight_of(equation, i)*spring_loss(equation%springs(i)%spring, &
            equation%state%springs(i), x)
      end do
   end function springs_loss

   !> Energy stored in vertical elements: in tendons, and in all others, for each wall [J/kg].
   function elements_energy(equation, theta) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: energy(2)
      real(wp) :: x
      integer :: i, k

      energy = 0
      if (.not. allocated(equation%elements)) return
      do i = 1, size(equation%elements)
         associate (element => equation%elements(i), side => equation%state%side)
            k = merge(1, 2, element%group == of_cable)
            x = stroke_at(element%stroke, side, side*theta)
            if (element%spring > 0) then
               energy(k) = energy(k) + element%weight*spring_energy(equation%springs( &
                  element%spring)%spring, equation%state%springs(element%spring), x)
            else
               energy(k) = energy(k) + element%weight*x*(element%force_0 &
                  + merge(side, 1, element%is_signed)*element%stiffness*x/2)
            end if
         end associate
      end do
   end function elements_energy

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
         associate (spring => equation%springs(i)%spring, branch => equation%state%springs(i))
            if (equation%springs(i)%element == 0) energy(2) = energy(2) + frame_mass(equation) &
               *(spring_energy(spring, branch, x) - equation%springs(i)%share &
               *(equation%p%omega_s*x)**2/2)
         end associate
      end do
   end function yielding_energy

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
      state%springs = new_branch(model%springs%spring)
      if (allocated(state%is_beyond)) state%is_beyond = .false.
      call follow_branches(model, state)
   end subroutine reset_springs

   !> Load springs at rest to an initial rotation, as if it had grown slowly from zero.
   subroutine load_to(model, state, theta)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: window(2)
      !! [rad] or [m]

      if (.not. model%has_bilinear_springs) return
      do
         call renew_window(model, state)
         window = [state%low, state%high]
         if (theta > state%high) then
            call pass_window(model, state, is_rising=.true.)
         else if (theta < state%low) then
            call pass_window(model, state, is_rising=.false.)
         else
            exit
         end if
         ! a limit beyond the numbers is not passed; the run then ends with a state not finite
         if (.not. any(abs([state%low, state%high] - window) > 0)) exit
      end do
      ! springs that have yielded during this loading may unload from here on
      call turn_back(model, state, theta)
      call renew_window(model, state)
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
      do i = 1, size(model%springs)
         if (can_move(model, state%side, i)) call narrow_window(model, state, i, window)
      end do
   end function window_of

   !> Return whether a spring moves on a side.
   pure logical function can_move(model, side, number)
      type(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      integer, intent(in) :: number
      !! number of the spring

      can_move = .true.
      associate (element => model%springs(number)%element)
         if (element > 0) can_move = moves(model%elements(element)%stroke, side)
      end associate
   end function can_move

   !> Narrow a window to the limits of one spring.
   subroutine narrow_window(model, state, number, window)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      type(window_t), intent(inout) :: window
      real(wp) :: x(2)
      !! limits of the elongation [m]
      real(wp) :: theta(2)
      real(wp) :: turn

      associate (spring => model%springs(number)%spring, branch => state%springs(number))
         if (loading_direction(spring, branch) /= 0) window%ends_at_peak = .true.
         call spring_limits(spring, branch, x(1), x(2))
      end associate
      theta = [rotation_at(model, state, number, x(1)), rotation_at(model, state, number, x(2))]
      window%low = max(window%low, minval(theta))
      window%high = min(window%high, maxval(theta))
      if (.not. allocated(state%is_beyond)) return
      turn = state%side*turn_of(model, state%side, number)
      if (state%is_beyond(number) .eqv. state%side > 0) then
         window%low = max(window%low, turn)
      else
         window%high = min(window%high, turn)
      end if
   end subroutine narrow_window

   !> Rotation at which the stroke of a spring turns, the largest number if it does not [rad].
   pure real(wp) function turn_of(model, side, number) result(phi)
      type(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      integer, intent(in) :: number
      !! number of the spring

      phi = huge(phi)
      associate (element => model%springs(number)%element)
         if (element > 0) phi = turning_angle(model%elements(element)%stroke, side)
      end associate
      if (phi >= model%angle_limit) phi = huge(phi)
   end function turn_of

   !> Range of |theta| up to overturning in which the elongation of a spring is monotone [rad].
   pure function monotone_range(model, state, number) result(phi)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp) :: phi(2)

      phi = [least_angle(model), model%angle_limit]
      if (.not. allocated(state%is_beyond)) return
      if (state%is_beyond(number)) then
         phi(1) = turn_of(model, state%side, number)
      else
         phi(2) = min(phi(2), turn_of(model, state%side, number))
      end if
   end function monotone_range

   !> Sign of the change of a spring's elongation where |theta| grows.
   integer function growth(model, state, number)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp) :: reach(2)

      growth = state%side
      if (model%springs(number)%element == 0) return
      reach = monotone_reach(model, state, number)
      growth = merge(1, -1, reach(2) > reach(1))
   end function growth

   !> Elongations at the ends of the monotone range [m].
   pure function monotone_reach(model, state, number) result(reach)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp) :: reach(2)
      real(wp) :: phi(2)

      if (model%springs(number)%element == 0 .or. .not. model%has_impacts) then
         phi = monotone_range(model, state, number)
         reach = [elongation_of(model, state%side, number, phi(1)), elongation_of(model, &
            state%side, number, phi(2))]
         return
      end if
      reach = model%springs(number)%ends(:, state%side)
      if (allocated(state%is_beyond)) then
         if (state%is_beyond(number)) return
      end if
      reach = [0.0_wp, reach(1)]
   end function monotone_reach

   !> Elongation of a spring at a rotation on a side [m].
   pure real(wp) function elongation_of(model, side, number, phi) result(x)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! +1 or -1
      integer, intent(in) :: number
      !! number of the spring
      real(wp), intent(in) :: phi
      !! |theta| [rad]; bare frame: displacement [m]

      associate (element => model%springs(number)%element)
         if (element == 0) then
            x = straight_displacement(model, side, side*phi)
         else
            x = stroke_at(model%elements(element)%stroke, side, phi)
         end if
      end associate
   end function elongation_of

   !> Rotation (bare frame: displacement) at which a spring has the elongation x. It is +-huge
   !> outside the range in which the elongation is monotone.
   real(wp) function rotation_at(model, state, number, x) result(theta)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp), intent(in) :: x
      !! elongation [m]
      type(bracket_t) :: bracket
      !! bracket of |theta|
      real(wp) :: phi(2), reach(2)
      integer :: direction
      !! +1 if the elongation grows with |theta|

      theta = x
      if (.not. model%has_wall) return
      associate (side => state%side)
         reach = monotone_reach(model, state, number)
         direction = merge(1, -1, reach(2) > reach(1))
         theta = direction*side*huge(x)
         if (x >= maxval(reach)) return
         theta = -theta
         if (x <= minval(reach)) return
         theta = side*angle_of(model, state, number, x)
         if (abs(theta) < huge(x)) return
         phi = monotone_range(model, state, number)
         bracket = bracket_between(phi(1), phi(2))
         do while (bracket%is_open)
            call narrow(bracket, direction*(elongation_of(model, side, number, bracket%middle) &
               - x) >= 0)
         end do
         theta = side*bracket%high
      end associate
   end function rotation_at

   !> |theta| at which a spring reaches an elongation, if a closed formula exists; else the largest
   !> number. The far end of a tilted link has no formula.
   pure real(wp) function angle_of(model, state, number, x) result(angle)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp), intent(in) :: x
      !! elongation [m]
      logical :: is_beyond
      real(wp) :: away
      !! displacement from the pivot over 2R [-]
      real(wp) :: cosine
      !! cosine of alpha - phi

      angle = huge(angle)
      associate (R => model%p%R, shape => model%geometry, side => state%side, &
         element => model%springs(number)%element)
         if (element > 0) then
            is_beyond = .false.
            if (allocated(state%is_beyond)) is_beyond = state%is_beyond(number)
            angle = angle_of_stroke(model%elements(element)%stroke, side, x, is_beyond)
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
      do number = 1, size(model%springs)
         if (can_move(model, state%side, number)) call pass_one(model, state, number, limit, &
            is_rising)
      end do
      call follow_branches(model, state)
      call renew_window(model, state)
   end subroutine pass_window

   !> Begin the next branch of one spring if its limit or its turn is at this rotation.
   subroutine pass_one(model, state, number, limit, is_rising)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: number
      !! number of the spring
      real(wp), intent(in) :: limit
      !! limit of the rotation or displacement [rad] or [m]
      logical, intent(in) :: is_rising
      !! theta grows
      real(wp) :: x(2)
      logical :: grows
      !! true if the elongation grows

      associate (spring => model%springs(number)%spring)
         call spring_limits(spring, state%springs(number), x(1), x(2))
         grows = (is_rising .eqv. state%side > 0) .eqv. growth(model, state, number) > 0
         if (abs(rotation_at(model, state, number, merge(x(2), x(1), grows)) - limit) <= 0) then
            call pass_limit(spring, state%springs(number), grows)
         end if
         if (.not. allocated(state%is_beyond)) return
         if (abs(state%side*turn_of(model, state%side, number) - limit) > 0) return
         state%is_beyond(number) = is_rising .eqv. state%side > 0
         if (loading_direction(spring, state%springs(number)) /= 0) call turn_spring(spring, &
            state%springs(number), elongation_of(model, state%side, number, abs(limit)))
      end associate
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
      integer :: forward
      !! direction of continued loading of a spring
      integer :: i

      if (.not. (model%has_bilinear_springs .and. state%ends_at_peak)) return
      passes = .false.
      if (present(goes_on)) passes = goes_on
      unloads = .false.
      do i = 1, size(model%springs)
         associate (spring => model%springs(i)%spring)
            if (loading_direction(spring, state%springs(i)) == 0) cycle
            if (.not. can_move(model, state%side, i)) cycle
            forward = 0
            if (present(onward)) forward = onward*state%side*growth(model, state, i)
            if (loading_direction(spring, state%springs(i)) == forward) cycle
            if (passes .and. goes_through(model, i)) cycle
            call turn_spring(spring, state%springs(i), elongation_of(model, state%side, i, &
               state%side*theta))
         end associate
         unloads = .true.
      end do
      if (unloads) call follow_branches(model, state)
   end subroutine turn_back

   !> Return whether a spring goes on where the wall changes its pivot: that of a frame whose law
   !> has wear, and an element that sinks on one side as it rises on the other.
   pure logical function goes_through(model, number)
      type(model_t), intent(in) :: model
      integer, intent(in) :: number
      !! number of the spring

      associate (element => model%springs(number)%element)
         if (element == 0) then
            goes_through = has_wear(model%springs(number)%spring)
         else
            associate (stroke => model%elements(element)%stroke)
               goes_through = stroke%arm(1)*stroke%arm(-1) <= 0 .and. moves(stroke, 1) &
                  .and. moves(stroke, -1)
            end associate
         end if
      end associate
   end function goes_through

   !> Force of the frame's springs over m_s [m/s2].
   real(wp) function frame_force(equation, theta) result(force)
      type(equation_t), intent(in) :: equation
      !! equation with springs
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      integer :: i

      force = 0
      do i = 1, size(equation%springs)
         if (equation%springs(i)%element > 0) exit
         force = force + spring_force(equation%springs(i)%spring, equation%state%springs(i), &
            elongation_of(equation, equation%state%side, i, equation%state%side*theta))
      end do
   end function frame_force

   !> Number of tendons that have broken.
   pure integer function broken_tendons(state) result(n)
      type(discrete_state_t), intent(in) :: state

      n = 0
      if (allocated(state%springs)) n = count(is_broken(state%springs))
   end function broken_tendons

   !> Loss of the force of a tendon at theta = 0, over m_w g [-].
   real(wp) function prestress_loss(equation, element, theta) result(loss)
      type(equation_t), intent(in) :: equation
      type(element_t), intent(in) :: element
      real(wp), intent(in) :: theta
      !! current rotation [rad]
      type(branch_t) :: unloaded

      loss = 0
      if (element%spring == 0) return
      unloaded = equation%state%springs(element%spring)
      call turn_spring(equation%springs(element%spring)%spring, unloaded, &
         stroke_at(element%stroke, equation%state%side, equation%state%side*theta))
      loss = (element%force_0 - max(0.0_wp, unloaded%offset))/equation%p%g
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
      real(wp) :: residuals(count(equation%springs%element == 0))
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
      real(wp) :: parts(count(equation%springs%element == 0))
      !! (springs of the frame, which come first)

      associate (n => size(parts), state => equation%state)
         parts = spring_plastic(equation%springs(:n)%spring, state%springs(:n), &
            straight_displacement(equation, state%side, theta))
      end associate
   end function plastic_parts

end module rwmf_model_hysteresis_spring_set
