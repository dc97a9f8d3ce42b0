!> Peak for `accuracy` and `verify`.
!>
!> `&solver accuracy_of` selects the peak. The default is the largest displacement of the frame or,
!> without a frame, the largest rotation.
module rwmf_simulation_peak
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_values, only: is_present, levels_of, numbered, value_of, values_t
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_problem_quantity_table, only: all_quantities, key_length, look_up, of_demands, &
      of_envelopes, requested_by
   use rwmf_simulation_state_result, only: result_t, result_values
   implicit none
   private

   public :: ask_for_peak, list_reported, peak_of, reports_peak

contains

   !> Request the outputs that the peak needs, in addition to those of `&output`.
   pure subroutine ask_for_peak(case)
      type(case_t), intent(inout) :: case
      integer :: place, number

      call look_up(trim(case%solver%accuracy_of), place, number)
      if (place == 0) return
      if (requested_by(all_quantities(place)) /= 'reactions') return
      if (.not. allocated(case%output)) case%output = output_t(energy=.false.)
      if (all_quantities(place)%observed == of_demands) then
         case%output%demands = .true.
      else if (all_quantities(place)%observed == of_envelopes) then
         case%output%envelopes = .true.
      else
         case%output%reactions = .true.
      end if
   end subroutine ask_for_peak

   !> Return whether a result contains the peak named in the case.
   pure logical function reports_peak(case, result) result(reports)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      integer :: place, number

      call look_up(trim(case%solver%accuracy_of), place, number)
      reports = place > 0
      if (reports) reports = is_present(result%values, all_quantities(place)%id, number)
   end function reports_peak

   !> Peak of a run; 0 if its event does not occur.
   pure real(wp) function peak_of(case, result) result(peak)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      !! result of a run of the case
      integer :: place, number

      if (case%solver%accuracy_of /= '') then
         call look_up(trim(case%solver%accuracy_of), place, number)
         peak = 0
         if (is_present(result%values, all_quantities(place)%id, number)) peak = &
            value_of(result%values, all_quantities(place)%id, number)
      else if (allocated(result%u_s_max)) then
         peak = result%u_s_max
      else
         peak = max(result%theta_max, -result%theta_min)
      end if
   end function peak_of

   !> List the wanted keys that a result reports.
   pure subroutine list_reported(result, is_wanted, keys)
      type(result_t), intent(in) :: result
      logical, intent(in) :: is_wanted(:)
      !! (quantities of the table) true for wanted quantities
      character(key_length), allocatable, intent(out) :: keys(:)
      !! (keys) with the number of a floor or storey in place of '{i}'
      type(values_t) :: values
      integer :: i

      values = result_values(result)
      allocate (keys(0))
      do i = 1, size(all_quantities)
         if (.not. is_wanted(i)) cycle
         associate (levels => levels_of(values, all_quantities(i)%id))
            if (size(levels) > 0) keys = [keys, numbered(trim(all_quantities(i)%key), levels)]
         end associate
      end do
   end subroutine list_reported

end module rwmf_simulation_peak
