!> Vertical ground motion: in the frame of the ground the wall weighs m_w (g + v_g'').
!>
!> The cable force P does not depend on the motion of the ground, and the frame's mass moves
!> horizontally only. So the only effect is the moment of m_w v_g'' about the pivot.
module rwmf_model_effects_vertical_motion
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, model_t
   use rwmf_model_scene, only: on_weight
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_real, group_values_t, has_group, has_key, text_of
   use rwmf_problem_key, only: any_real, fixed_by, optional_key, positive, unless
   use rwmf_problem_record, only: fill_source, read_once
   use rwmf_problem_rules, only: check_one_of, fail_key
   implicit none
   private

   public :: vertical_group
   public :: prepare_vertical

contains

   !> Describe the group `&vertical`: its keys and the procedures that check and read them.
   type(case_group_t) function vertical_group() result(group)
      group%name = 'vertical'
      group%after = 'motion'
      group%needs(1) = 'wall'
      group%reasons(1) = 'a frame moves horizontally only'
      group%keys = [ &
         optional_key('vertical', 'ratio', 'real', '-', '', any_real, &
            'vertical over horizontal ground acceleration; exactly one of ratio and file'), &
         optional_key('vertical', 'file', 'text', '', '', '', &
            'record of the vertical acceleration (positive upward), relative to the case file'), &
         fixed_by(read_once, optional_key('vertical', 'dt', 'real', 's', '', positive, &
            'sampling interval; required for one column unless the file states it, refused ' &
               //'for two columns and AT2')), &
         optional_key('vertical', 'unit', 'choice', '', '', 'g m/s2 cm/s2', &
            'of the accelerations; required unless the file states it; refused for AT2'), &
         unless('vertical.ratio', &
            optional_key('vertical', 'scale', 'real', '-', '1.0', any_real, &
            'factor on the record'))]
      group%check => check_vertical
      group%fill => fill_vertical
      group%is_present => has_vertical
      group%is_beyond_element => has_record
      group%no_element = '&vertical file: the host hands over the motion, and &vertical ratio ' &
         //'follows it'
   end function vertical_group

   !> Check that the group gives either a ratio to the horizontal motion or a record.
   subroutine check_vertical(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: record_keys(3) = [character(5) :: 'dt', 'unit', 'scale']
      logical :: is_still
      integer :: i

      call check_one_of(values, 'vertical', 'ratio', 'file', 'of the vertical motion', error)
      if (allocated(error) .or. has_key(values, 'vertical', 'file')) return
      is_still = .not. has_group(values, 'motion')
      if (.not. is_still) is_still = text_of(values, 'motion', 'kind') == 'none'
      if (is_still) then
         call fail_key(values, 'vertical', 'ratio', 'must not be given without a horizontal ' &
            //'&motion, which it multiplies', error)
         return
      end if
      do i = 1, size(record_keys)
         if (.not. has_key(values, 'vertical', trim(record_keys(i)))) cycle
         call fail_key(values, 'vertical', trim(record_keys(i)), 'must not be given beside ' &
            //'ratio: it belongs to a record', error)
         return
      end do
   end subroutine check_vertical

   subroutine fill_vertical(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%upward)
      call get_real(case%values, 'vertical', 'ratio', case%upward%ratio)
      call fill_source(case%values, 'vertical', case%upward)
   end subroutine fill_vertical

   pure logical function has_vertical(case)
      type(case_t), intent(in) :: case

      has_vertical = allocated(case%upward)
   end function has_vertical

   pure logical function has_record(case)
      type(case_t), intent(in) :: case

      has_record = allocated(case%upward_record)
   end function has_record

   !> Prepare the contribution of the vertical motion to the equation, if the case has it.
   subroutine prepare_vertical(case, equation, vertical)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: vertical

      vertical%is_present = has_vertical(case)
      if (.not. vertical%is_present) return
      equation%has_vertical = .true.
      vertical%n_coef = 1
      vertical%coefficients => vertical_coefficients
      vertical%acts = on_weight
   end subroutine prepare_vertical

   pure subroutine vertical_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      coef(1) = 1/model%p%R
   end subroutine vertical_coefficients

end module rwmf_model_effects_vertical_motion
