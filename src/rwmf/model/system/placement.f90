!> Placement of a case's tendons and devices: the vertical elements of the wall, their springs and
!> their terms in the equation.
module rwmf_model_system_placement
   use rwmf_core_kinds, only: wp
   use rwmf_model_elements, only: element_t, of_cable, of_coupling, of_damper, of_fuse, of_restraint
   use rwmf_model_equation, only: equation_t, sprung_t
   use rwmf_model_hysteresis_spring_laws, only: new_spring
   use rwmf_model_hysteresis_spring_set, only: add_springs
   use rwmf_model_lanes, only: axis_coefficients, chord_coefficients, line_coefficients, &
      rise_coefficients
   use rwmf_model_scene, only: add_term, axis_term, chord_term, elsewhere, in_cable, line_term, &
      rise_term, term_t, under_corner
   use rwmf_model_spring, only: spring_t
   use rwmf_model_stroke, only: along_axis, along_chord, along_line, stroke_t, rising
   use rwmf_problem_case, only: case_t, devices_t
   use rwmf_problem_tendon_stroke, only: elongation_at_alpha
   implicit none
   private

   public :: place_elements, add_element_terms

contains

   !> Place all vertical elements of a case, tendons first.
   subroutine place_elements(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      !! equation with its wall

      if (.not. equation%has_wall) return
      equation%walls = case%wall%walls
      if (allocated(case%cable)) call place_tendons(case, equation)
      if (allocated(case%damper)) call place_devices(case, case%damper, of_damper, equation)
      if (allocated(case%nl_damper)) call place_devices(case, case%nl_damper, of_damper, equation)
      if (allocated(case%fuse)) call place_devices(case, case%fuse, of_fuse, equation)
      if (allocated(case%coupling)) call place_devices(case, case%coupling, of_coupling, equation)
      if (allocated(case%restraint)) call place_devices(case, case%restraint, of_restraint, &
         equation)
      if (.not. allocated(equation%elements)) return
      equation%has_sides = equation%has_impacts .and. any(equation%elements%group /= of_cable &
         .or. abs(equation%elements%offset) > 0 .or. equation%elements%is_signed)
      equation%may_hold = any(equation%elements%group == of_fuse &
         .or. equation%elements%group == of_coupling .or. equation%elements%group == of_restraint)
   end subroutine place_elements

   !> Add the terms of the elements, one for each kind of stroke.
   subroutine add_element_terms(equation)
      type(equation_t), intent(inout) :: equation
      integer :: path
      !! of the cable force: known to the loops over lanes if all tendons end at the top of the axis

      if (.not. allocated(equation%elements)) return
      associate (kind => equation%elements%stroke%kind, scene => equation%scene, &
         is_nonlinear => equation%elements%force_1 > 0, is_spring => equation%elements%spring > 0)
         path = in_cable
         if (any(equation%elements%group == of_cable .and. (abs(equation%elements%offset) > 0 &
            .or. equation%elements%stroke%height < (1 - 1.0e-9_wp) &
            *2*equation%p%R*equation%p%cos_alpha))) then
            path = elsewhere
         end if
         if (any(kind == along_axis)) call add_term(scene, term_t(axis_term, &
            n_coef=axis_coefficients, acts=path, &
            has_springs=any(kind == along_axis .and. is_spring)))
         if (any(kind == along_line)) call add_term(scene, term_t(line_term, &
            n=count(kind == along_line), n_coef=line_coefficients*count(kind == along_line), &
            acts=path, has_springs=any(kind == along_line .and. is_spring)))
         if (any(kind == along_chord .and. .not. is_nonlinear)) call add_term(scene, &
            term_t(chord_term, n_coef=chord_coefficients, acts=under_corner, &
            has_springs=any(kind == along_chord .and. is_spring)))
         if (any(kind == rising)) call add_term(scene, term_t(rise_term, &
            n_coef=rise_coefficients, has_springs=any(kind == rising .and. is_spring)))
      end associate
   end subroutine add_element_terms

   !> Arms of an element by side, from its offset; on a hinge the distance from it.
   pure function arms_of(equation, b, offset) result(arm)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: b, offset
      !! half width of the wall and offset [m]
      real(wp) :: arm(-1:1)

      arm = [b + offset, 0.0_wp, b - offset]
      if (.not. equation%has_impacts) arm = -offset
   end function arms_of

   !> Place the tendons. Their stiffness follows from eta_0 and eta_alpha.
   subroutine place_tendons(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(element_t) :: tendon
      real(wp) :: yield, rupture, hardening, length, x
      integer :: i

      associate (cable => case%cable, wall => case%wall, g => equation%p%g)
         do i = 1, size(cable%eta_0)
            tendon = element_t(of_cable)
            if (allocated(cable%offset)) tendon%offset = cable%offset(i)
            tendon%stroke = stroke_t(along_axis, arms_of(equation, wall%b, tendon%offset), 2*wall%h)
            if (allocated(cable%height)) tendon%stroke%height = cable%height(i)
            if (cable%law == 'truss') tendon%stroke%kind = along_line
            x = elongation_at_alpha(cable%law, wall%h, wall%b, tendon%stroke%height)
            tendon%force_0 = g*cable%eta_0(i)
            tendon%stiffness = g*(cable%eta_alpha(i) - cable%eta_0(i))/x
            tendon%is_signed = case%model%formulation == 'published'
            length = tendon%stroke%height
            if (allocated(cable%length)) length = cable%length(i)
            if (allocated(cable%area) .or. allocated(cable%rupture_strain)) tendon%length = length
            yield = huge(yield)
            if (allocated(cable%eta_y)) yield = g*cable%eta_y(i)
            rupture = huge(rupture)
            if (allocated(cable%rupture_strain)) rupture = length*cable%rupture_strain(i) &
               - tendon%force_0/tendon%stiffness
            hardening = 0
            if (allocated(cable%hardening)) hardening = cable%hardening(i)
            if (allocated(cable%eta_y) .or. allocated(cable%rupture_strain) &
                .or. (minval(tendon%stroke%arm([-1, 1])) < 0 .and. tendon%stiffness > 0)) then
               call append(case, tendon, equation, new_spring(tendon%stiffness, yield, hardening, &
                  tendon%force_0, is_tendon=.true., rupture=rupture))
            else
               call append(case, tendon, equation)
            end if
         end do
      end associate
   end subroutine place_tendons

   !> Place the devices of a group. The weight is their number for each wall.
   subroutine place_devices(case, devices, group, equation)
      type(case_t), intent(in) :: case
      type(devices_t), intent(in) :: devices
      integer, intent(in) :: group
      !! number of the group
      type(equation_t), intent(inout) :: equation
      type(element_t) :: device
      real(wp), allocatable :: offset(:)
      integer :: i

      associate (wall => case%wall, g => equation%p%g, walls => real(equation%walls, wp))
         offset = [-wall%b, wall%b]
         if (group == of_coupling) offset = [0.0_wp]
         if (allocated(devices%offset)) offset = devices%offset
         do i = 1, size(offset)
            device = element_t(group, offset=offset(i))
            device%stroke = stroke_t(along_chord, arms_of(equation, wall%b, offset(i)))
            select case (group)
            case (of_coupling)
               device%stroke = stroke_t(rising, [-1, 0, 1]*(2*wall%b + devices%span))
               device%weight = (walls - 1)/walls
            case (of_restraint)
               device%stroke%kind = rising
               device%stroke%height = devices%height(i)
               device%weight = 1/walls
            case default
               ! each wall has its own devices under its base
            end select
            if (allocated(devices%c)) device%c = devices%c(i)
            if (allocated(devices%k)) device%stiffness = devices%k(i)
            if (allocated(devices%eta_1)) then
               device%force_1 = g*devices%eta_1(i)
               device%exponent = devices%exponent(i)
            end if
            if (allocated(devices%eta_y)) then
               call append(case, device, equation, new_spring(devices%eta_y(i)*g &
                  /devices%stroke_y(i), devices%eta_y(i)*g, devices%hardening(i), law=devices%law))
            else
               call append(case, device, equation)
            end if
         end do
      end associate
   end subroutine place_devices

   !> Append an element, with its spring with memory if it has one.
   subroutine append(case, element, equation, spring)
      type(case_t), intent(in) :: case
      type(element_t), intent(in) :: element
      type(equation_t), intent(inout) :: equation
      type(spring_t), intent(in), optional :: spring
      integer :: n

      if (.not. allocated(equation%elements)) allocate (equation%elements(0))
      equation%elements = [equation%elements, element]
      if (.not. present(spring)) return
      n = size(equation%elements)
      call add_springs([sprung_t(spring, n)], case%model%overturning_angle, equation)
      equation%elements(n)%spring = size(equation%springs)
   end subroutine append

end module rwmf_model_system_placement
