!> Nonlinear viscous dampers between the foundation and each corner of the base. Their force is F_1
!> |v|**exponent against the velocity v of the stroke.
!>
!> The stroke of the damper under the lifting corner is the chord 4b sin(phi/2). It has the
!> velocity v = 2b cos(phi/2) phi' and the arm 2b cos(phi/2). Under a hinged wall both dampers act,
!> each with half of this stroke and arm. The law has a kink at v = 0. The loop of the force is in
!> `rwmf_model_effects_nl_damper_loop`.
module rwmf_model_effects_nl_damper
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, model_t
   use rwmf_model_scene, only: under_corner
   use rwmf_problem_case, only: case_t, has_numbers, keep_numbers, numbers_of
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: real_of
   use rwmf_problem_key, only: dimensional, not_negative, required, usually, with_si
   implicit none
   private

   public :: nl_damper_group
   public :: prepare_nl_damper

contains

   !> Describe the group `&nl_damper`: its keys and the procedures that check and read them.
   type(case_group_t) function nl_damper_group() result(group)
      group%name = 'nl_damper'
      group%needs(1) = 'wall'
      group%reasons(1) = 'dampers work under its corners'
      group%keys = [ &
         with_si('N', usually('[1e-4, 10]', required('nl_damper', 'eta_1', 'real', '-', &
            not_negative, 'force at 1 m/s of the damper under each corner over m_w g'))), &
         usually('[1e3, 1e8]', dimensional('nl_damper', 'F_1', 'real', 'N', 'eta_1', '', &
            'or that force', not_negative)), &
         required('nl_damper', 'exponent', 'real', '-', '[0.15, 2]', &
            'power of the velocity of the stroke that the force follows; 1 is &damper')]
      group%fill => fill_nl_damper
      group%is_present => has_nl_damper
   end function nl_damper_group

   subroutine fill_nl_damper(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      call keep_numbers(case, 'nl_damper', [real_of(case%values, 'nl_damper', 'eta_1'), &
         real_of(case%values, 'nl_damper', 'exponent')])
   end subroutine fill_nl_damper

   pure logical function has_nl_damper(case)
      type(case_t), intent(in) :: case

      has_nl_damper = has_numbers(case, 'nl_damper')
   end function has_nl_damper

   !> Prepare the contribution of the dampers to the equation, if the case has them.
   subroutine prepare_nl_damper(case, equation, damper)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: damper
      real(wp) :: numbers(2)

      damper%is_present = has_nl_damper(case)
      if (.not. damper%is_present) return
      numbers = numbers_of(case, 'nl_damper')
      associate (exponent => numbers(2))
         damper%constants = [numbers(1)*case%model%g, exponent]
         if (.not. equation%has_impacts) damper%constants(1) = damper%constants(1)/2**exponent
      end associate
      damper%n_coef = 3
      damper%coefficients => nl_damper_coefficients
      damper%acts = under_corner
      damper%has_corner_at_turn = .true.
   end subroutine prepare_nl_damper

   pure subroutine nl_damper_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      coef = [2*model%p%R*model%p%sin_alpha, effect%constants(1)*2*model%p%sin_alpha/model%p%R, &
         effect%constants(2)]
   end subroutine nl_damper_coefficients

end module rwmf_model_effects_nl_damper
