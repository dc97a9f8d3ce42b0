!> Groups of the numerical model, the integration and the output: `&model`, `&solver`, `&output`.
module rwmf_input_groups_analysis
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_simulation_factory, only: all_methods, current_method, old_methods
   use rwmf_paper_paper_scene, only: check_paper_scene
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_real, group_values_t, has_group, has_key, integer_of, &
      logical_of, real_of, text_of
   use rwmf_problem_key, only: not_negative, optional_key, positive, unless, usually
   use rwmf_problem_record, only: upward_group
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_problem_quantity_table, only: all_quantities, canonical_key, is_peak, key_length, &
      look_up
   use rwmf_simulation_quantity_words, only: meant_quantity, suggest_quantity
   implicit none
   private

   public :: model_group, solver_group, output_group

contains

   !> Group `&model` with its keys and hooks.
   type(case_group_t) function model_group() result(group)
      group%name = 'model'
      group%is_of_scene = .false.
      group%keys = [ &
         optional_key('model', 'formulation', 'choice', '', 'exact', &
            'published symmetric exact', 'Eq. (15) as printed, or one that conserves energy'), &
         usually('[9, 10.5]', &
            optional_key('model', 'g', 'real', 'm/s2', '9.81', positive, 'gravity')), &
         optional_key('model', 'overturning_angle', 'real', 'rad', 'pi/2', '(0, pi/2]', &
            'rotation at which the wall counts as overturned')]
      group%fill => fill_model
   end function model_group

   subroutine fill_model(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%model%formulation = text_of(case%values, 'model', 'formulation')
      case%model%g = real_of(case%values, 'model', 'g')
      case%model%overturning_angle = real_of(case%values, 'model', 'overturning_angle')
   end subroutine fill_model

   !> Group `&solver` with its keys and hooks.
   type(case_group_t) function solver_group() result(group)
      group%name = 'solver'
      group%is_of_scene = .false.
      group%keys = [ &
         optional_key('solver', 'method', 'choice', '', 'auto', all_methods, &
            'integrator; auto: dop853 for runs, by scene and tolerance for spectra; paper: Eq. ' &
            //'(15) by CVODE'), &
         unless('solver.accuracy', &
            optional_key('solver', 'rtol', 'real', '-', '1.0e-9', '[1.0e-14, 0.1]', &
            'relative tolerance; below the lower limit round-off governs every method')), &
         optional_key('solver', 'accuracy', 'real', '-', '', '[2.0e-14, 0.1]', &
            'relative error of a peak asked instead of rtol'), &
         optional_key('solver', 'accuracy_of', 'text', '', '', 'see outputs.md', &
            'key of the peak that accuracy and verify are about; absent: u_s_max_m (no frame: ' &
            //'theta_max)'), &
         optional_key('solver', 'verify', 'logical', '', '.false.', '', &
            'estimate error and sensitivity of a peak by further runs'), &
         optional_key('solver', 'atol', 'real', 'rad', '', positive, &
            'absolute tolerance (bare frame: m); absent: from rtol and the response'), &
         optional_key('solver', 't_end', 'real', 's', '', not_negative, &
            'end of the simulation; required but for a record: its last sample'), &
         optional_key('solver', 'max_steps', 'integer', '', '50000000', '>= 1', &
            'most steps of one simulation')]
      group%keys(1)%former = old_methods
      group%check => check_solver
      group%fill => fill_solver
   end function solver_group

   !> Check that rtol and accuracy are not both given, and that the end of the simulation is known.
   !> Without `t_end`, only a record defines it.
   subroutine check_solver(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: problem = 'the key t_end is missing (end of the simulation): ' &
         //'must be a number >= 0 [s]; only records without a pulse give it by default'

      if (has_key(values, 'solver', 'rtol') .and. has_key(values, 'solver', 'accuracy')) then
         call fail_key(values, 'solver', 'accuracy', 'must not be given beside rtol, which it ' &
            //'replaces', error)
         return
      end if
      call check_peak(values, error)
      if (allocated(error)) return
      if (has_key(values, 'solver', 't_end') .or. ends_with_record(values)) then
         return
      else if (has_group(values, 'solver')) then
         call fail_group(values, 'solver', problem, error)
      else
         call fail(error, err_input, '&solver: '//problem)
      end if
   end subroutine check_solver

   !> Check that `accuracy_of` is a peak of the table and that accuracy or verify uses it.
   subroutine check_peak(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      character(key_length) :: request, near
      integer :: place, number

      if (.not. has_key(values, 'solver', 'accuracy_of')) return
      if (.not. (has_key(values, 'solver', 'accuracy') &
         .or. logical_of(values, 'solver', 'verify'))) then
         call fail_key(values, 'solver', 'accuracy_of', 'needs accuracy, or verify = .true., in ' &
            //'the same group', error)
         return
      end if
      request = text_of(values, 'solver', 'accuracy_of')
      call look_up(trim(canonical_key(request)), place, number)
      if (place > 0) then
         if (is_peak(all_quantities(place))) return
      end if
      problem = trim(request)//' is no peak of a run'
      near = meant_quantity(trim(request))
      call look_up(trim(near), place, number)
      if (place > 0) then
         if (.not. is_peak(all_quantities(place))) near = ''
      end if
      call suggest_quantity(near, problem)
      call fail_key(values, 'solver', 'accuracy_of', problem, error)
   end subroutine check_peak

   !> True if a record defines the end of the simulation, and no pulse can last longer.
   pure logical function ends_with_record(values)
      type(group_values_t), intent(in) :: values
      logical :: is_still

      ends_with_record = .false.
      is_still = .not. has_group(values, 'motion')
      if (.not. is_still) then
         ends_with_record = text_of(values, 'motion', 'kind') == 'record'
         is_still = text_of(values, 'motion', 'kind') == 'none'
      end if
      if (is_still) ends_with_record = has_key(values, upward_group, 'file')
   end function ends_with_record

   subroutine fill_solver(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%solver%method = current_method(text_of(case%values, 'solver', 'method'))
      case%solver%rtol = real_of(case%values, 'solver', 'rtol')
      case%solver%max_steps = integer_of(case%values, 'solver', 'max_steps')
      case%solver%verify = logical_of(case%values, 'solver', 'verify')
      call get_real(case%values, 'solver', 'accuracy', case%solver%accuracy)
      if (has_key(case%values, 'solver', 'accuracy_of')) case%solver%accuracy_of = &
         canonical_key(text_of(case%values, 'solver', 'accuracy_of'))
      call get_real(case%values, 'solver', 'atol', case%solver%atol)
      call get_real(case%values, 'solver', 't_end', case%solver%t_end)
      if (case%solver%method == 'paper') call check_paper_scene(case, error)
   end subroutine fill_solver

   !> Group `&output` with its keys and hooks.
   type(case_group_t) function output_group() result(group)
      group%name = 'output'
      group%is_of_scene = .false.
      group%keys = [ &
         optional_key('output', 'dt', 'real', 's', '', positive, &
            'interval of the history; absent: no history'), &
         optional_key('output', 'energy', 'logical', '', '.false.', '', &
            'energy ledger: its parts at the end, with dt in every row'), &
         optional_key('output', 'reactions', 'logical', '', '.true.', '', &
            'reactions of the base, demands and member forces of a run: extrema, with dt rows'), &
         usually('[0.05, 3]', optional_key('output', 'friction_limit', 'real', '-', '', positive, &
            'coefficient of friction: whether and when the friction demand exceeds it')), &
         optional_key('output', 'conditioning', 'logical', '', '', '', &
            'sensitivity of each peak to the motion; absent: in runs, not in spectra and sweeps')]
      group%check => check_output
      group%fill => fill_output
   end function output_group

   !> Check that a friction limit is given only for the reactions of a wall without a shear key.
   subroutine check_output(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_key(values, 'output', 'friction_limit')) return
      if (.not. logical_of(values, 'output', 'reactions')) then
         call fail_key(values, 'output', 'friction_limit', 'needs reactions = .true. in the same ' &
            //'group', error)
      else if (.not. has_group(values, 'wall')) then
         call fail_key(values, 'output', 'friction_limit', 'must not be given without &wall ' &
            //'(friction holds the wall)', error)
      else if (logical_of(values, 'wall', 'shear_key')) then
         call fail_key(values, 'output', 'friction_limit', 'must not be given with &wall ' &
            //'shear_key = .true., which holds the wall in the place of friction', error)
      end if
   end subroutine check_output

   subroutine fill_output(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%output = output_t(energy=logical_of(case%values, 'output', 'energy'), &
         reactions=logical_of(case%values, 'output', 'reactions'), &
         demands=logical_of(case%values, 'output', 'reactions'), &
         envelopes=logical_of(case%values, 'output', 'reactions'))
      call get_real(case%values, 'output', 'friction_limit', case%output%friction_limit)
      call get_real(case%values, 'output', 'dt', case%output%dt)
      if (has_key(case%values, 'output', 'conditioning')) case%output%conditioning = &
         logical_of(case%values, 'output', 'conditioning')
   end subroutine fill_output

end module rwmf_input_groups_analysis
