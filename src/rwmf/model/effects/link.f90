!> Link of finite length between wall and frame, `&link`, Eqs (2), (3).
module rwmf_model_effects_link
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, model_t
   use rwmf_model_kinematics, only: link_row
   use rwmf_model_lanes, only: link_coefficients
   use rwmf_model_scene, only: through_link
   use rwmf_problem_case, only: case_t, link_t
   use rwmf_problem_case_group, only: case_group_t, two_corners
   use rwmf_problem_group_values, only: group_values_t, real_of, text_of
   use rwmf_problem_key, only: positive, required, usually
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_problem_wall_size, only: half_diagonal
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: link_group, prepare_link

contains

   !> Describe the group `&link`: its keys and the procedures that check and read them.
   type(case_group_t) function link_group() result(group)
      group%name = 'link'
      group%needs = [character(12) :: 'wall', 'frame']
      group%reasons = 'a link joins wall and frame'
      group%not_on_base = two_corners
      group%keys = [usually('[0.1, 100]', required('link', 'L', 'real', 'm', positive, &
         'length of the link, Eqs (2), (3); absent: infinitely long'))]
      group%check => check_link
      group%fill => fill_link
      group%is_present => has_link
   end function link_group

   !> Check that the link cannot become vertical: it must exceed the vertical travel of the corner.
   subroutine check_link(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: h
      real(wp) :: limit
      real(wp) :: travel

      if (text_of(values, 'model', 'formulation') == 'published') then
         call fail_group(values, 'link', "must not be given with &model formulation = " &
            //"'published', where the link is infinitely long; 'symmetric' and " &
            //"'exact' allow it", error)
         return
      end if
      h = real_of(values, 'wall', 'h')
      limit = real_of(values, 'model', 'overturning_angle')
      travel = max(2*h*(1 - cos(limit)), 2*(half_diagonal(h, real_of(values, 'wall', 'b')) - h))
      if (real_of(values, 'link', 'L') > travel) return
      call fail_key(values, 'link', 'L', 'must be > '//trim(real_to_text(travel)) &
         //' m, the travel of the corner up to the overturning angle', error)
   end subroutine check_link

   subroutine fill_link(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%link = link_t(real_of(case%values, 'link', 'L'))
   end subroutine fill_link

   !> Prepare the tilt of the link, which is part of the kinematics of all lanes (`tilt_link`).
   subroutine prepare_link(case, link)
      type(case_t), intent(in) :: case
      type(contribution_t), intent(out) :: link

      link%is_present = has_link(case)
      if (.not. link%is_present) return
      link%n_coef = link_coefficients
      link%is_kinematic = .true.
      link%has_sides = .true.
      link%coefficients => coefficients_of_link
      link%acts = through_link
   end subroutine prepare_link

   pure subroutine coefficients_of_link(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      coef = reshape(link_row(model%geometry, state%side), [link_coefficients])
   end subroutine coefficients_of_link

   pure logical function has_link(case)
      type(case_t), intent(in) :: case

      has_link = allocated(case%link)
   end function has_link

end module rwmf_model_effects_link
