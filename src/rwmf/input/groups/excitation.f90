!> Group of the horizontal ground motion, `&motion`.
module rwmf_input_groups_excitation
   use rwmf_core_error, only: error_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_real, group_values_t, has_key, integer_of, real_of, &
      text_of
   use rwmf_problem_key, only: any_real, fixed_by, key_t, of_kind, positive, required, usually
   use rwmf_problem_record, only: fill_source, read_once
   use rwmf_problem_rules, only: check_one_of, fail_group
   implicit none
   private

   public :: motion_group

   character(*), parameter :: velocity_kinds = &
      'one_sine one_cosine sine type_c mavroeidis_papageorgiou'
   !! pulses with a velocity amplitude
   character(*), parameter :: pulse_kinds = velocity_kinds//' ricker ricker_antisymmetric'
   !! kinds of motion that are pulses

contains

   !> Group `&motion` with its keys and hooks.
   type(case_group_t) function motion_group() result(group)
      group%name = 'motion'
      group%keys = motion_keys()
      group%check => check_motion
      group%fill => fill_motion
      group%is_present => has_motion
   end function motion_group

   pure function motion_keys() result(keys)
      type(key_t), allocatable :: keys(:)
      character(*), parameter :: kinds = 'none '//pulse_kinds//' record'

      keys = [ &
         required('motion', 'kind', 'choice', '', kinds, &
            'one_sine: Eq. (16), one_cosine: Eq. (17), sine: cycles; all: reference/pulses.md'), &
         usually('[0.001, 5]', of_kind(pulse_kinds, 'a_max_g', 'real', '-', '', any_real, &
            'largest acceleration over g; exactly one of a_max_g and v_p')), &
         usually('[0.005, 6]', of_kind(velocity_kinds, 'v_p', 'real', 'm/s', '', any_real, &
            'velocity amplitude of Eqs (16), (17), reference/pulses.md; no Ricker pulse has it')), &
         usually('[0.2, 300]', of_kind(pulse_kinds, 'omega_p', 'real', 'rad/s', '', positive, &
            'angular frequency; exactly one of omega_p and T_p')), &
         usually('[0.02, 30]', &
            of_kind(pulse_kinds, 'T_p', 'real', 's', '', positive, 'period of the pulse')), &
         of_kind('sine', 'cycles', 'real', '-', '1.0', positive, 'number of cycles'), &
         of_kind('type_c', 'n_pulses', 'integer', '', '1', '>= 1', 'n of the pulse C_n'), &
         of_kind('mavroeidis_papageorgiou', 'gamma_p', 'real', '-', '', '(1, 1000]', &
            'gamma, the number of cycles in the envelope; required for this kind'), &
         of_kind('mavroeidis_papageorgiou', 'nu', 'real', 'rad', '0.0', any_real, &
            'phase of the carrier: 0 symmetric, pi/2 antisymmetric velocity'), &
         of_kind(pulse_kinds, 't_0', 'real', 's', '0.0', any_real, 'start of the pulse'), &
         of_kind('record', 'file', 'text', '', '', '', &
            'path, relative to the case file; required for a record'), &
         fixed_by(read_once, of_kind('record', 'dt', 'real', 's', '', positive, &
            'sampling interval; required for one column unless the file states it, refused ' &
               //'for two columns and AT2')), &
         of_kind('record', 'unit', 'choice', '', '', 'g m/s2 cm/s2', &
            'of the accelerations; required unless the file states it; refused for AT2'), &
         of_kind('record', 'scale', 'real', '-', '1.0', any_real, 'factor on the accelerations')]
   end function motion_keys

   !> Check the keys that the kind of motion requires.
   subroutine check_motion(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: kind

      kind = text_of(values, 'motion', 'kind')
      if (index(' '//pulse_kinds//' ', ' '//kind//' ') > 0) then
         call check_pulse(values, kind, error)
      else if (kind == 'record' .and. .not. has_key(values, 'motion', 'file')) then
         call fail_group(values, 'motion', 'the key file is missing: must be the path of the ' &
            //'record in quotes', error)
      end if
   end subroutine check_motion

   !> Check amplitude and period of a pulse, and the keys that its kind requires.
   subroutine check_pulse(values, kind, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: kind
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: condition

      condition = "with kind = '"//kind//"'"
      if (index(' '//velocity_kinds//' ', ' '//kind//' ') > 0) then
         call check_one_of(values, 'motion', 'a_max_g', 'v_p', condition, error)
      else if (.not. has_key(values, 'motion', 'a_max_g')) then
         call fail_group(values, 'motion', 'the key a_max_g is missing (largest acceleration ' &
            //'over g): must be given '//condition//', any finite number [-]', error)
      end if
      if (allocated(error)) return
      call check_one_of(values, 'motion', 'omega_p', 'T_p', condition, error)
      if (allocated(error) .or. has_key(values, 'motion', 'gamma_p')) return
      if (kind /= 'mavroeidis_papageorgiou') return
      call fail_group(values, 'motion', 'the key gamma_p is missing (number of cycles in the ' &
         //'envelope): must be given '//condition//', a number in (1, 1000] [-]', error)
   end subroutine check_pulse

   subroutine fill_motion(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%motion)
      case%motion%kind = text_of(case%values, 'motion', 'kind')
      case%motion%cycles = real_of(case%values, 'motion', 'cycles')
      case%motion%n_pulses = integer_of(case%values, 'motion', 'n_pulses')
      case%motion%nu = real_of(case%values, 'motion', 'nu')
      case%motion%t_0 = real_of(case%values, 'motion', 't_0')
      call get_real(case%values, 'motion', 'a_max_g', case%motion%a_max_g)
      call get_real(case%values, 'motion', 'v_p', case%motion%v_p)
      call get_real(case%values, 'motion', 'omega_p', case%motion%omega_p)
      call get_real(case%values, 'motion', 'T_p', case%motion%T_p)
      call get_real(case%values, 'motion', 'gamma_p', case%motion%gamma_p)
      call fill_source(case%values, 'motion', case%motion)
   end subroutine fill_motion

   !> True for a motion other than kind 'none', which is free vibration.
   pure logical function has_motion(case)
      type(case_t), intent(in) :: case

      has_motion = .false.
      if (allocated(case%motion)) has_motion = case%motion%kind /= 'none'
   end function has_motion

end module rwmf_input_groups_excitation
