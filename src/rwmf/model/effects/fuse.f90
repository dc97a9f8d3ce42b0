!> Hysteretic fuses at the edges of the base, `&fuse`.
module rwmf_model_effects_fuse
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, model_t, &
      place_left, place_right, sprung_t
   use rwmf_model_hysteresis_spring_laws, only: new_spring
   use rwmf_model_hysteresis_spring_set, only: add_springs, fuses_energy
   use rwmf_model_scene, only: under_corner
   use rwmf_model_spring, only: spring_t
   use rwmf_problem_case, only: case_t, fuse_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_group_values, only: derive, group_values_t, has_key, real_of, text_of
   use rwmf_problem_key, only: below_one, dimensional, optional_key, positive, required, &
      with_si, usually
   use rwmf_problem_rules, only: check_period, fail_key
   implicit none
   private

   public :: fuse_group, prepare_fuse

contains

   !> Describe the group `&fuse`: its keys and the procedures that check and read them.
   type(case_group_t) function fuse_group() result(group)
      group%name = 'fuse'
      group%needs(1) = 'wall'
      group%reasons(1) = 'fuses work at its edges'
      group%keys = [ &
         with_si('N', usually('[1e-4, 10]', required('fuse', 'eta_y', 'real', '-', positive, &
            'yield force of the fuse at each edge of the base over m_w g'))), &
         usually('[1e-5, 0.2]', &
            required('fuse', 'stroke_y', 'real', 'm', positive, &
            'stroke at which it yields first')), &
         usually('[1e3, 1e8]', &
            dimensional('fuse', 'F_y', 'real', 'N', 'eta_y', '', 'or the yield force')), &
         usually('[1e5, 1e11]', dimensional('fuse', 'k', 'real', 'N/m', 'stroke_y', 'F_y', &
            'or the stiffness until then: stroke_y = F_y/k')), &
         optional_key('fuse', 'hardening', 'real', '-', '0.0', below_one, &
            'stiffness of the fuse after yield over its elastic one'), &
         optional_key('fuse', 'law', 'choice', '', 'elastic_plastic', &
            'elastic_plastic friction flag', 'bilinear, slipping, or self-centring'), &
         optional_key('fuse', 'breakaway', 'real', '-', '1.0', '[1, 10]', &
            'force at which friction lets go over that at which it slips; friction only'), &
         optional_key('fuse', 'flag_height', 'real', '-', '1.0', '(0, 1]', &
            'force by which a flag unloads lower, over its yield force; flag only')]
      group%derive => derive_fuse
      group%check => check_fuse
      group%fill => fill_fuse
      group%is_present => has_fuse
      group%add_events => add_branch_event
      group%no_element = '&fuse: what yields has to be remembered, and an element holds no ' &
         //'state; a wall that steps with the host (create_stepping) does'
   end function fuse_group

   subroutine derive_fuse(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_key(values, 'fuse', 'k')) call derive(values, 'fuse', 'stroke_y', 'k', &
         [real_of(values, 'fuse', 'F_y')/real_of(values, 'fuse', 'k')])
   end subroutine derive_fuse

   !> Check that keys of a law are given only with it, and that the fuse leaves the wall a period
   !> long enough to integrate.
   subroutine check_fuse(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      character(11), parameter :: keys(2) = [character(11) :: 'breakaway', 'flag_height']
      character(8), parameter :: laws(2) = [character(8) :: 'friction', 'flag']
      integer :: i

      do i = 1, size(keys)
         if (.not. has_key(values, 'fuse', trim(keys(i)))) cycle
         if (text_of(values, 'fuse', 'law') == laws(i)) cycle
         call fail_key(values, 'fuse', trim(keys(i)), "belongs to law = '" &
            //trim(laws(i))//"'", error)
         return
      end do
      call check_period(sqrt(real_of(values, 'fuse', 'stroke_y')), &
         sqrt(real_of(values, 'fuse', 'eta_y'))*sqrt(real_of(values, 'model', 'g')), problem)
      if (allocated(problem)) call fail_key(values, 'fuse', 'stroke_y', &
         problem//', eta_y m_w g/stroke_y', error)
   end subroutine check_fuse

   subroutine fill_fuse(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%fuse = fuse_t(real_of(case%values, 'fuse', 'eta_y'), &
         real_of(case%values, 'fuse', 'stroke_y'), real_of(case%values, 'fuse', 'hardening'))
      case%fuse%spring%name = text_of(case%values, 'fuse', 'law')
      case%fuse%spring%breakaway = real_of(case%values, 'fuse', 'breakaway')
      case%fuse%spring%flag_height = real_of(case%values, 'fuse', 'flag_height')
   end subroutine fill_fuse

   pure logical function has_fuse(case)
      type(case_t), intent(in) :: case

      has_fuse = allocated(case%fuse)
   end function has_fuse

   !> Prepare the contribution of the fuses to the equation, if the case has them.
   subroutine prepare_fuse(case, equation, fuse)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: fuse
      type(spring_t) :: spring
      real(wp) :: stroke_y
      !! stroke at first yield [m]

      fuse%is_present = has_fuse(case)
      if (.not. fuse%is_present) return
      ! Both fuses of a hinged wall act at half the arm. They are modelled as one, that of the left
      ! corner, with twice the stroke, since the stroke used here is that of a rocking wall.
      stroke_y = case%fuse%stroke_y
      if (.not. equation%has_impacts) stroke_y = 2*stroke_y
      spring = new_spring(case%fuse%eta_y*equation%p%g/stroke_y, case%fuse%eta_y*equation%p%g, &
         case%fuse%hardening, law=case%fuse%spring)
      call add_springs([sprung_t(spring, place_left), sprung_t(spring, place_right)], &
         case%model%overturning_angle, equation)
      equation%has_fuses = equation%has_impacts
      fuse%n_coef = 3
      fuse%coefficients => fuse_coefficients
      fuse%has_sides = .true.
      fuse%energy => fuses_energy
      fuse%acts = under_corner
   end subroutine prepare_fuse

   !> Coefficients of the fuse under the lifting corner, and force of the other. The fuses are the
   !> last two springs, left and right.
   pure subroutine fuse_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)
      integer :: n, other

      n = size(model%springs)
      other = n - 1
      if (state%side == place_left) then
         other = n
         n = n - 1
      end if
      coef(:2) = 2*model%p%sin_alpha*[state%springs(n)%offset/model%p%R, &
         4*model%p%sin_alpha*state%springs(n)%slope]
      coef(3) = state%springs(other)%offset
   end subroutine fuse_coefficients

   pure subroutine add_branch_event(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      names = [character(name_length) :: names, 'branch']
   end subroutine add_branch_event

end module rwmf_model_effects_fuse
