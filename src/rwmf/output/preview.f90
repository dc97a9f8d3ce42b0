!> What a case will simulate and report, before it is simulated.
module rwmf_output_preview
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_spring_set, only: is_elastic_plastic
   use rwmf_output_summary, only: joined, list_absent_effects, list_effects, summarise, &
      summary_item_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_result, only: event_branch, event_impact, event_lift_off, event_name, &
      event_overturned, event_peak, event_rest, event_rupture, result_t
   use rwmf_simulation_simulate, only: simulate
   implicit none
   private

   public :: preview_text

   character(*), parameter :: tab = achar(9)

contains

   !> Lines of a word and the names that belong to it, separated by tabs: `effects`, `absent`
   !> (effects that are not simulated), `states`, `events`, `scalars` (keys of the summary) and
   !> `columns` (of the history; nothing without one).
   !>
   !> The outputs are those of the same case when it ends as it begins: no list of them is kept
   !> that could differ from what is written. Errors: as `simulate`.
   subroutine preview_text(case, text, error)
      type(case_t), intent(in) :: case
      !! valid
      character(:), allocatable, intent(out) :: text
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: instant
      type(result_t) :: result

      instant = case
      instant%solver%t_end = 0
      if (allocated(instant%frame)) then
         ! each period of a spectrum reports the same
         if (.not. allocated(instant%frame%T_s)) instant%frame%T_s = 1
      end if
      call simulate(instant, result, error)
      if (allocated(error)) return
      ! texts: one thread at a time, see `read_case_text`
      !$omp critical (rwmf_text)
      call compose(case, instant, result, text)
      !$omp end critical (rwmf_text)
   end subroutine preview_text

   subroutine compose(case, instant, result, text)
      type(case_t), intent(in) :: case
      type(case_t), intent(in) :: instant
      !! without any duration
      type(result_t), intent(in) :: result
      !! of it
      character(:), allocatable, intent(out) :: text
      type(summary_item_t), allocatable :: items(:)
      character(:), allocatable :: scalars
      integer :: i

      call summarise(instant, result, items)
      scalars = ''
      do i = 1, size(items)
         scalars = scalars//tab//items(i)%key
      end do
      text = line('effects', joined(list_effects(case))) &
         //line('absent', joined(list_absent_effects(case))) &
         //line('states', joined(list_states(case)))//line('events', joined(list_events(case))) &
         //'scalars'//scalars//new_line('a')
      if (allocated(result%history)) text = text//line('columns', joined(result%history%names))
   end subroutine compose

   pure function line(word, names) result(text)
      character(*), intent(in) :: word
      character(*), intent(in) :: names
      character(:), allocatable :: text

      text = word//tab//names//new_line('a')
   end function line

   !> Unknowns of the equation of motion.
   pure function list_states(case) result(names)
      type(case_t), intent(in) :: case
      character(24), allocatable :: names(:)
      !! (states)
      character(24), allocatable :: places(:)
      character(24), allocatable :: velocities(:)
      logical :: is_smooth
      logical :: is_full
      integer :: n
      integer :: i

      names = [character(24) :: 'u_s_m', 'u_s_dot_m_s']
      if (allocated(case%wall)) names = [character(24) :: 'theta_rad', 'theta_dot_rad_s']
      is_smooth = .false.
      if (allocated(case%yielding)) then
         is_smooth = .not. is_elastic_plastic(case%yielding)
      end if
      is_full = .false.
      if (allocated(case%storeys)) is_full = case%storeys%coupling == 'full'
      if (is_smooth .and. .not. is_full) names = [character(24) :: names, 'z']
      if (.not. is_full) return
      n = size(case%storeys%frame%m) - 1
      allocate (places(n), velocities(n))
      do i = 1, n
         write (places(i), '(a, i0, a)') 'floor_', i, '_m'
         write (velocities(i), '(a, i0, a)') 'floor_', i, '_dot_m_s'
      end do
      names = [character(24) :: names, places, velocities]
      if (.not. is_smooth) return
      deallocate (places)
      allocate (places(n + 1))
      do i = 1, n + 1
         write (places(i), '(a, i0)') 'z_', i
      end do
      names = [character(24) :: names, places]
   end function list_states

   !> Events that are located.
   pure function list_events(case) result(names)
      type(case_t), intent(in) :: case
      character(10), allocatable :: names(:)
      !! (kinds)
      integer, allocatable :: kinds(:)
      integer :: i

      kinds = [event_peak]
      if (allocated(case%wall)) then
         kinds = [event_peak, event_overturned]
         if (case%wall%base == 'rocking') then
            kinds = [event_impact, event_peak, event_lift_off, event_rest, event_overturned]
         end if
      end if
      if (allocated(case%yielding) .or. allocated(case%fuse)) kinds = [kinds, event_branch]
      if (allocated(case%cable)) then
         if (allocated(case%cable%eta_y)) kinds = [kinds, event_branch]
         if (allocated(case%cable%rupture_strain)) kinds = [kinds, event_rupture]
      end if
      if (count(kinds == event_branch) > 1) kinds = [event_branch, pack(kinds, &
         kinds /= event_branch)]
      allocate (names(size(kinds)))
      do i = 1, size(kinds)
         names(i) = event_name(kinds(i))
      end do
   end function list_events

end module rwmf_output_preview
