!> Outputs of a stepping wall by the keys of the table of quantities: columns of a history at the
!> current time, and scalars of a run up to the current time.
module rwmf_embedding_outputs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_stepping, only: require, stepping_t
   use rwmf_embedding_wall_instance, only: copy_base, wall_instance_t
   use rwmf_problem_quantity_table, only: all_quantities, look_up
   use rwmf_problem_quantity_values, only: value_of, values_t
   use rwmf_simulation_base_base_record, only: base_columns => find_columns
   use rwmf_simulation_base_base_run, only: base_motion_t, result_on_base
   use rwmf_simulation_recorder_recorder, only: create_columns, find_columns, find_rates, &
      observe_present, recorder_t
   use rwmf_simulation_run_values, only: fill_result
   use rwmf_simulation_state_hybrid_state, only: is_at_rest
   use rwmf_simulation_state_result, only: result_t, result_values
   use rwmf_text_strings, only: shown
   implicit none
   private

   public :: find_output, query_outputs

   integer, parameter :: per_row = 10000
   !! numbers of outputs per row of the table, for the number of a storey or floor

contains

   !> Find the number by which `query_outputs` knows an output.
   subroutine find_output(key, number, error)
      character(*), intent(in) :: key
      !! key of a history column or of a scalar, 'storey_2_drift'
      integer, intent(out) :: number
      !! number for `query_outputs`
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for any other key
      integer :: place, storey

      call look_up(key, place, storey)
      number = per_row*place + storey
      if (place > 0) then
         if (is_column(place) .or. index(all_quantities(place)%outputs, 'run') > 0) return
      end if
      call fail(error, err_input, shown(key)//': must be a column of the history or a number of ' &
         //'a run (reference/outputs.md)')
   end subroutine find_output

   !> True for a column of the history.
   pure logical function is_column(place)
      integer, intent(in) :: place
      !! row of the table

      is_column = index(all_quantities(place)%outputs, 'history') > 0
   end function is_column

   !> Return outputs at the current time.
   !>
   !> Maxima need the requests of `&output` in the case. An output that does not apply, or is not
   !> requested, is NaN.
   subroutine query_outputs(stepping, numbers, values, error)
      type(stepping_t), intent(in) :: stepping
      integer, intent(in) :: numbers(:)
      !! (outputs) results of `find_output`
      real(wp), intent(out) :: values(:)
      !! (outputs) in the units of their keys; counts unchanged, 1 for true, 0 for false
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a handle without a wall and a number of no output
      type(values_t) :: columns, scalars
      integer :: i
      logical :: has_columns, has_scalars

      values = ieee_value(1.0_wp, ieee_quiet_nan)
      call require(stepping, error)
      if (allocated(error)) return
      if (any(numbers < per_row .or. numbers >= per_row*(size(all_quantities) + 1))) then
         call fail(error, err_input, 'a number of no output: ask for it by its key')
         return
      end if
      has_columns = .false.
      has_scalars = .false.
      do i = 1, size(numbers)
         associate (place => numbers(i)/per_row, storey => modulo(numbers(i), per_row))
            if (is_column(place)) then
               if (.not. has_columns) call find_row(stepping%instance, columns)
               has_columns = .true.
               values(i) = value_of(columns, all_quantities(place)%id, storey)
            else
               if (.not. has_scalars) call find_scalars(stepping%instance, scalars)
               has_scalars = .true.
               values(i) = value_of(scalars, all_quantities(place)%id, storey)
            end if
         end associate
      end do
   end subroutine query_outputs

   !> Find the columns of a history at the current time.
   subroutine find_row(instance, row)
      type(wall_instance_t), intent(in) :: instance
      type(values_t), intent(out) :: row
      type(recorder_t) :: recorder
      type(base_motion_t) :: base

      if (allocated(instance%base)) then
         call copy_base(instance, base)
         call base_columns(instance%case, base%scene, base%regime, base%series, base%t, row)
         return
      end if
      recorder = instance%recorder
      associate (hybrid => instance%hybrid)
         call create_columns(recorder, instance%case, instance%equation, hybrid%y)
         call find_columns(recorder, instance%equation, hybrid%t, hybrid%y, is_at_rest(hybrid))
      end associate
      row = recorder%row
   end subroutine find_row

   !> Find the scalars of a run that ends at the current time.
   subroutine find_scalars(instance, scalars)
      type(wall_instance_t), intent(in) :: instance
      type(values_t), intent(out) :: scalars
      type(recorder_t) :: recorder
      type(base_motion_t) :: base
      type(result_t) :: result
      real(wp) :: y_dot(size(instance%hybrid%y))

      if (allocated(instance%base)) then
         call copy_base(instance, base)
         call result_on_base(instance%case, base, result)
      else
         recorder = instance%recorder
         recorder%keeps_history = .false.
         associate (hybrid => instance%hybrid, equation => instance%equation)
            call find_rates(equation, hybrid%t, hybrid%y, is_at_rest(hybrid), y_dot)
            call observe_present(recorder, equation, hybrid%t, hybrid%y, y_dot)
            call fill_result(instance%case, equation, hybrid, recorder, result)
         end associate
         result%steps = instance%steps
      end if
      scalars = result_values(result)
   end subroutine find_scalars

end module rwmf_embedding_outputs
