!> Preview of the effects and outputs of a case, without simulating it.
module rwmf_output_preview
   use rwmf_core_error, only: err_input, error_t
   use rwmf_model_effects_list, only: all_effects
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_output_summary, only: joined, list_absent_effects, list_effects, summarise, &
      summary_item_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_group_values, only: applies, group_values_t, has_group, has_key, text_of
   use rwmf_simulation_simulate, only: simulate_instant
   use rwmf_simulation_state_result, only: result_t
   use rwmf_spectrum_quantities, only: check_request, requested_keys_of
   use rwmf_spectrum_threads, only: choose_threads
   use rwmf_text_text_buffer, only: append, text_buffer_t
   implicit none
   private

   public :: preview_text, check_run

   character(*), parameter :: tab = achar(9)
   integer, parameter :: note_length = 120

contains

   !> Write lines with a word and its names, separated by tabs. The words are `effects`, `absent`
   !> (effects that are not simulated), `states`, `events`, `scalars` (keys of the summary),
   !> `columns` (of the history; empty without one) and `notes` (sentences).
   !>
   !> The outputs are those of the case with zero duration. No separate list could therefore differ
   !> from the written outputs. Errors: as `simulate` and `check_request`.
   subroutine preview_text(case, text, error)
      type(case_t), intent(in) :: case
      !! valid
      character(:), allocatable, intent(out) :: text
      !! the lines, each with its line feed; not allocated after an error
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: instant
      type(result_t) :: result

      call look_ahead(case, instant, result, error)
      if (.not. allocated(error)) call compose(case, instant, result, text)
   end subroutine preview_text

   !> Check a case for invalid input before anything is computed or written.
   subroutine check_run(case, error)
      type(case_t), intent(in) :: case
      !! valid
      type(error_t), allocatable, intent(out) :: error
      !! quantities that do not apply, too many threads (`err_input`)
      integer, parameter :: all_threads = 0
      type(case_t) :: instant
      type(result_t) :: result
      integer :: threads

      if (allocated(case%spectrum)) call choose_threads(all_threads, threads, error)
      if (.not. allocated(error)) call look_ahead(case, instant, result, error)
      if (.not. allocated(error)) return
      ! a numerical failure is reported by the run itself
      if (error%stat /= err_input) deallocate (error)
   end subroutine check_run

   !> Simulate the case with zero duration.
   subroutine look_ahead(case, instant, result, error)
      type(case_t), intent(in) :: case
      type(case_t), intent(out) :: instant
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(motion_t) :: motion

      motion = motion_from_case(case)
      if (allocated(case%spectrum)) call check_request(case, motion, &
         requested_keys_of(case), error)
      if (.not. allocated(error)) call simulate_instant(case, motion, instant, result, error)
   end subroutine look_ahead

   subroutine compose(case, instant, result, text)
      type(case_t), intent(in) :: case
      type(case_t), intent(in) :: instant
      !! the case with zero duration
      type(result_t), intent(in) :: result
      !! result of `instant`
      character(:), allocatable, intent(out) :: text
      type(summary_item_t), allocatable :: items(:)
      type(text_buffer_t) :: scalars
      character(name_length), allocatable :: states(:)
      character(name_length), allocatable :: events(:)
      character(note_length), allocatable :: notes(:)
      integer :: i
      logical :: is_shared
      !! the rocking wall has a frame or a tendon

      call list_states(case, states)
      call list_events(case, events)
      text = ''
      call append_line('effects', list_effects(case), text)
      call append_line('absent', list_absent_effects(case), text)
      call append_line('states', states, text)
      call append_line('events', events, text)
      call summarise(instant, result, items)
      call append(scalars, 'scalars')
      do i = 1, size(items)
         call append(scalars, tab//items(i)%key)
      end do
      text = text//scalars%room(:scalars%length)//new_line('a')
      if (allocated(result%history)) call append_line('columns', result%history%names, text)
      ! list the defaults in use that an earlier version had otherwise, if they affect the results
      allocate (notes(0))
      is_shared = has_group(case%values, 'frame') .or. has_group(case%values, 'cable')
      if (has_group(case%values, 'wall') .and. is_shared .and. text_of(case%values, 'wall', &
         'base') == 'rocking') then
         call add_note(case%values, 'model', 'formulation', 'exact', "0.2 it was 'published'", &
            notes)
      end if
      if (applies(case%values, 'impact') .and. .not. has_group(case%values, 'impact')) then
         call add_note(case%values, 'impact', 'rule', 'coupled', "0.8 it was 'none' (e = 1)", notes)
      end if
      call append_line('notes', notes, text)
   end subroutine compose

   !> Append a word and its names.
   pure subroutine append_line(word, names, text)
      character(*), intent(in) :: word
      character(*), intent(in) :: names(:)
      character(:), allocatable, intent(inout) :: text

      text = text//word//tab//joined(names)//new_line('a')
   end subroutine append_line

   !> List the unknowns of the equation of motion.
   subroutine list_states(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(out) :: names(:)
      !! (states)
      type(case_group_t), allocatable :: effects(:)
      integer :: i

      names = [character(name_length) :: 'u_s_m', 'u_s_dot_m_s']
      if (allocated(case%wall)) names = [character(name_length) :: 'theta_rad', &
         'theta_dot_rad_s']
      effects = all_effects()
      do i = 1, size(effects)
         if (.not. associated(effects(i)%add_states)) cycle
         if (effects(i)%is_present(case)) call effects(i)%add_states(case, names)
      end do
   end subroutine list_states

   !> List the located events, each once.
   subroutine list_events(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(out) :: names(:)
      !! (kinds)
      character(name_length), allocatable :: found(:)
      type(case_group_t), allocatable :: effects(:)
      integer :: i

      found = [character(name_length) :: 'peak']
      if (allocated(case%wall)) then
         found = [character(name_length) :: 'peak', 'overturned']
         if (case%wall%base == 'rocking') found = [character(name_length) :: 'impact', &
            'peak', 'lift_off', 'rest', 'overturned']
      end if
      effects = all_effects()
      do i = 1, size(effects)
         if (.not. associated(effects(i)%add_events)) cycle
         if (effects(i)%is_present(case)) call effects(i)%add_events(case, found)
      end do
      allocate (names(0))
      do i = 1, size(found)
         if (.not. any(names == found(i))) names = &
            [character(name_length) :: names, found(i)]
      end do
   end subroutine list_events

   !> Add a note on a default in use, if an earlier version had another one.
   subroutine add_note(values, group, key, choice, before, notes)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: choice
      !! default value of the key
      character(*), intent(in) :: before
      !! an earlier version, and its behaviour
      character(note_length), allocatable, intent(inout) :: notes(:)

      if (has_key(values, group, key) .or. text_of(values, group, key) /= choice) return
      notes = [character(note_length) :: notes, '&'//group//' '//key//" = '"//choice &
         //"', because the case does not give it; before version "//before]
   end subroutine add_note

end module rwmf_output_preview
