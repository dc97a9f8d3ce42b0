!> Strokes and forces of the vertical elements over a run.
module rwmf_simulation_recorder_element_demands
   use rwmf_core_kinds, only: wp
   use rwmf_model_elements, only: element_force, element_t, of_cable, of_coupling, of_damper, &
      of_fuse, of_restraint
   use rwmf_model_equation, only: equation_t
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_hysteresis_spring_set, only: frame_force, prestress_loss
   use rwmf_model_stroke, only: stroke_at, turning_angle
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: id
   implicit none
   private

   public :: watched_elements, force_of, travel_of, largest_stroke, extremes_of, put_element_forces
   public :: put_frame_force, put_elements, element_extremes_t, resting_uplift, coupling_ratio
   public :: has_places, element_ids, of_force, of_least_force

   integer, parameter :: of_force = 5, of_least_force = 6
   !! places in `element_ids`
   integer, parameter :: element_ids(8, of_cable:of_restraint) = reshape([ &
      0, 0, 0, 0, id%cable_i_force_max_over_m_w_g, id%cable_i_force_min_over_m_w_g, &
      0, id%cable_i_prestress_loss_over_m_w_g, &
      id%fuse_i_stroke_max_m, id%fuse_i_stroke_min_m, 0, id%fuse_i_stroke_sum_m, &
      id%fuse_i_force_max_over_m_w_g, 0, id%fuse_i_force_end_over_m_w_g, 0, &
      0, 0, 0, 0, 0, 0, 0, 0, &
      0, 0, id%coupling_stroke_max_m, id%coupling_stroke_sum_m, &
      id%coupling_force_max_over_m_w_g, 0, id%coupling_force_end_over_m_w_g, 0, &
      id%restraint_i_stroke_max_m, id%restraint_i_stroke_min_m, 0, id%restraint_i_stroke_sum_m, &
      id%restraint_i_force_max_over_m_w_g, 0, id%restraint_i_force_end_over_m_w_g, 0], [8, 5])
   !! (outputs, groups) outputs of one element: largest and smallest stroke, largest magnitude and
   !! sum of strokes, largest, smallest and last force, loss at theta = 0; 0 for none

   !> Strokes and forces of one vertical element.
   type :: element_extremes_t
      integer :: group = 0
      !! its group, as in `rwmf_model_elements`
      real(wp) :: stroke(2) = 0
      !! smallest and largest stroke [m]
      real(wp) :: travel = 0
      !! sum of all strokes there and back [m]
      real(wp) :: force(2) = 0
      !! smallest force of a tendon, and largest magnitude, over m_w g [-]
      real(wp) :: force_end = 0
      !! force at the end over m_w g [-]
      real(wp) :: loss = 0
      !! lost force at theta = 0 over m_w g [-]
   end type element_extremes_t

contains

   !> Numbers of the elements with own outputs: all but dampers under the base, and a single tendon
   !> on the axis.
   pure function watched_elements(equation) result(numbers)
      type(equation_t), intent(in) :: equation
      integer, allocatable :: numbers(:)
      integer :: i

      allocate (numbers(0))
      if (.not. allocated(equation%elements)) return
      associate (group => equation%elements%group)
         numbers = pack([(i, i=1, size(group))], group /= of_damper .and. (group /= of_cable &
            .or. count(group == of_cable) > 1 .or. abs(equation%elements%offset) > 0))
      end associate
   end function watched_elements

   !> Return whether tendons stand off the axis, or couplings or restraints hold the wall.
   pure logical function has_places(equation)
      type(equation_t), intent(in) :: equation

      has_places = .false.
      if (.not. allocated(equation%elements)) return
      associate (group => equation%elements%group)
         has_places = any(group == of_coupling .or. group == of_restraint .or. (group == of_cable &
            .and. abs(equation%elements%offset) > 0))
      end associate
   end function has_places

   !> Force of an element, with its damper [m/s2].
   pure real(wp) function force_of(equation, number, y) result(force)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: number
      !! number of the element
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (side => equation%state%side)
         force = element_force(equation%elements(number), equation%state%springs, side, &
            side*y(1), side*y(2))
      end associate
   end function force_of

   !> Travel of an element between two rotations of one direction on the current side [m].
   pure real(wp) function travel_of(equation, number, theta_a, theta_b) result(travel)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: number
      !! number of the element
      real(wp), intent(in) :: theta_a, theta_b
      !! [rad]
      real(wp) :: x(3), phi(2), turn

      associate (stroke => equation%elements(number)%stroke, side => equation%state%side)
         phi = side*[theta_a, theta_b]
         x(1) = stroke_at(stroke, side, phi(1))
         x(3) = stroke_at(stroke, side, phi(2))
         x(2) = x(3)
         turn = turning_angle(stroke, side)
         if (turn > minval(phi) .and. turn < maxval(phi)) x(2) = stroke_at(stroke, side, turn)
      end associate
      travel = abs(x(2) - x(1)) + abs(x(3) - x(2))
   end function travel_of

   !> Smallest and largest stroke of an element in a range of rotations [m].
   pure function range_of(element, theta) result(x)
      type(element_t), intent(in) :: element
      real(wp), intent(in) :: theta(2)
      !! smallest and largest rotation [rad]
      real(wp) :: x(2)
      real(wp) :: phi(2)
      integer :: side

      x = [huge(x), -huge(x)]
      do side = -1, 1, 2
         if (maxval(side*theta) < 0) cycle
         phi = [max(0.0_wp, minval(side*theta)), maxval(side*theta)]
         call take(stroke_at(element%stroke, side, phi(1)))
         call take(stroke_at(element%stroke, side, phi(2)))
         associate (turn => turning_angle(element%stroke, side))
            if (turn > phi(1) .and. turn < phi(2)) call take(stroke_at(element%stroke, side, turn))
         end associate
      end do

   contains

      !> Extend the range to a stroke.
      pure subroutine take(stroke)
         real(wp), intent(in) :: stroke
         !! [m]

         x = [min(x(1), stroke), max(x(2), stroke)]
      end subroutine take

   end function range_of

   !> Largest magnitude of the strokes of all fuses at a rotation [m].
   pure real(wp) function largest_stroke(equation, theta) result(stroke)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      integer :: i

      stroke = 0
      do i = 1, size(equation%elements)
         if (equation%elements(i)%group == of_fuse) stroke = max(stroke, &
            abs(stroke_at(equation%elements(i)%stroke, equation%state%side, &
            equation%state%side*theta)))
      end do
   end function largest_stroke

   !> Collect strokes and forces of an element at the end of a run.
   type(element_extremes_t) function extremes_of(equation, number, theta, y) result(extremes)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: number
      !! number of the element
      real(wp), intent(in) :: theta(2)
      !! smallest and largest rotation [rad]
      real(wp), intent(in) :: y(:)
      !! (states) at the end

      associate (element => equation%elements(number))
         extremes%group = element%group
         extremes%stroke = range_of(element, theta)
         extremes%force_end = force_of(equation, number, y)/equation%p%g
         extremes%loss = prestress_loss(equation, element, y(1))
      end associate
   end function extremes_of

   !> Put strokes and forces of the vertical elements.
   pure subroutine put_elements(values, elements)
      type(values_t), intent(inout) :: values
      type(element_extremes_t), intent(in) :: elements(:)

      integer :: i, j
      real(wp) :: number(size(element_ids, 1))

      do i = 1, size(elements)
         associate (element => elements(i), ids => element_ids(:, elements(i)%group))
            number = [element%stroke(2), element%stroke(1), maxval(abs(element%stroke)), &
               element%travel, element%force(2), element%force(1), element%force_end, element%loss]
            do j = 1, size(number)
               if (ids(j) > 0) call put(values, ids(j), number(j:j), &
                  count(elements(:i - 1)%group == element%group))
            end do
         end associate
      end do
      associate (is_fuse => elements%group == of_fuse)
         if (.not. any(is_fuse)) return
         call put(values, id%fuse_stroke_max_m, maxval(max(elements%stroke(2), &
            -elements%stroke(1)), is_fuse))
         call put(values, id%fuse_stroke_sum_m, maxval(elements%travel, is_fuse))
      end associate
   end subroutine put_elements

   !> Ground acceleration over g at which the wall at rest lifts off before anything has yielded, to
   !> theta > 0 and to theta < 0 [-].
   pure function resting_uplift(equation) result(uplift)
      type(equation_t), intent(in) :: equation
      !! equation with a rocking wall
      real(wp) :: uplift(2)
      integer :: i

      associate (p => equation%p)
         uplift = p%R*p%sin_alpha
         if (allocated(equation%elements)) then
            do i = 1, size(equation%elements)
               associate (element => equation%elements(i))
                  uplift = uplift + element%weight*element%force_0/p%g*element%stroke%arm([1, -1])
               end associate
            end do
         end if
         uplift = uplift/(p%R*p%cos_alpha*(1 + 2*p%gamma*equation%floors%excited_mass_ratio))
      end associate
   end function resting_uplift

   !> Share of the couplings in the moment of all walls at small rotations, at yield [-].
   pure real(wp) function coupling_ratio(case) result(ratio)
      type(case_t), intent(in) :: case
      !! case with couplings that yield
      real(wp) :: resisting
      !! moment of weight and tendons over m_w g [m]

      associate (wall => case%wall, n => case%wall%walls)
         resisting = n*wall%b
         if (allocated(case%cable)) resisting = resisting*(1 + sum(case%cable%eta_0))
         ratio = (n - 1)*(2*wall%b + case%coupling%span)*case%coupling%eta_y(1)
         ratio = ratio/(ratio + resisting)
      end associate
   end function coupling_ratio

   !> Write the history columns of the elements' forces. Two fuses under the corners are the left
   !> and the right one.
   subroutine put_element_forces(row, equation, has_offsets, y)
      type(values_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      logical, intent(in) :: has_offsets
      !! the case gives the places of the fuses
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: force(size(equation%elements))
      integer :: i

      force = [(force_of(equation, i, y), i=1, size(force))]/equation%p%g
      associate (group => equation%elements%group, offset => equation%elements%offset)
         if (count(group == of_cable) > 1 .or. any(group == of_cable .and. abs(offset) > 0)) then
            call put(row, id%cable_i_force_over_m_w_g, pack(force, group == of_cable))
         end if
         if (has_offsets) then
            call put(row, id%fuse_i_force_over_m_w_g, pack(force, group == of_fuse))
         else if (any(group == of_fuse)) then
            i = findloc(group, of_fuse, dim=1)
            call put(row, id%fuse_left_force_over_m_w_g, force(i))
            call put(row, id%fuse_right_force_over_m_w_g, force(i + 1))
         end if
         if (any(group == of_coupling)) call put(row, id%coupling_force_over_m_w_g, &
            sum(force, group == of_coupling))
         if (any(group == of_restraint)) call put(row, id%restraint_i_force_over_m_w_g, &
            pack(force, group == of_restraint))
      end associate
   end subroutine put_element_forces

   !> Write the history column of the frame's total spring force.
   subroutine put_frame_force(row, equation, theta)
      type(values_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      !! equation with springs
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      if (any(equation%springs%element == 0)) call put(row, id%frame_force_over_m_s_g, &
         frame_force(equation, theta)/equation%p%g)
   end subroutine put_frame_force

end module rwmf_simulation_recorder_element_demands
