!> Named scalars of one simulation, for `rwmf run --json`, the Python results and
!> `CASE.summary.csv`. The table of `rwmf_problem_quantity_table` defines keys, kinds and order;
!> `result_values` gives the numbers.
!>
!> Keys that do not apply to the effects in the scene are absent.
module rwmf_output_summary
   use rwmf_core_kinds, only: i8, wp
   use rwmf_input_schema, only: all_groups
   use rwmf_problem_quantity_values, only: levels_of, numbered, value_of, values_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_quantity_table, only: all_quantities, id, is_peak, quantity_t, sensitivity_row
   use rwmf_simulation_state_result, only: result_t, result_values
   use rwmf_text_text_buffer, only: append, clear, text_buffer_t
   implicit none
   private

   public :: summary_item_t, summarise, summary_text, list_effects, list_absent_effects, joined

   !> Key with its value.
   type :: summary_item_t
      character(:), allocatable :: key
      !! name with unit suffix
      character(:), allocatable :: kind
      !! 'real', 'int', 'logical', 'text' or 'list'
      real(wp) :: number = 0
      !! value of a 'real' [unit of the key]
      integer(i8) :: count = 0
      !! value of an 'int'; 1 for a true 'logical'
      character(:), allocatable :: text
      !! value of a 'text'; items of a 'list' separated by tabs; otherwise ''
   end type summary_item_t

   character(*), parameter :: tab = achar(9)

contains

   !> Collect all applicable scalars, in the order of the outputs.
   subroutine summarise(case, result, items)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      type(summary_item_t), allocatable, intent(out) :: items(:)
      !! (keys)
      character(12), allocatable :: effects(:)
      type(values_t) :: values
      integer, parameter :: usual = 128
      integer :: i
      integer :: n

      allocate (items(usual))
      n = 0
      values = result_values(result)
      do i = 1, size(all_quantities)
         if (index(all_quantities(i)%outputs, 'run') == 0) cycle
         select case (all_quantities(i)%id)
         case (id%method)
            call append_item(items, n, all_quantities(i), 0, 0.0_wp, result%method)
         case (id%effects)
            ! outside the call below, in which gfortran 12 reads the length from freed memory
            effects = list_effects(case)
            call append_item(items, n, all_quantities(i), 0, 0.0_wp, joined(effects))
         case (id%warnings)
            if (allocated(result%warnings)) then
               call append_item(items, n, all_quantities(i), 0, 0.0_wp, joined(result%warnings))
            else
               call append_item(items, n, all_quantities(i), 0, 0.0_wp, '')
            end if
         case default
            call append_numbers(items, n, all_quantities(i), values)
         end select
      end do
      do i = 1, size(all_quantities)
         if (is_peak(all_quantities(i))) call append_numbers(items, n, &
            sensitivity_row(all_quantities(i)), values)
      end do
      call resize(items, n, n)
   end subroutine summarise

   !> Append a quantity if it applies, for a '{i}' key once per storey from the ground up.
   pure subroutine append_numbers(items, n, row, values)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      integer, intent(inout) :: n
      !! number of items so far
      type(quantity_t), intent(in) :: row
      !! row of the table
      type(values_t), intent(in) :: values
      integer :: i

      associate (floors => levels_of(values, row%id))
         do i = 1, size(floors)
            call append_item(items, n, row, floors(i), value_of(values, row%id, floors(i)), '')
         end do
      end associate
   end subroutine append_numbers

   !> Append one item.
   pure subroutine append_item(items, n, row, storey, value, text)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      integer, intent(inout) :: n
      !! number of items so far
      type(quantity_t), intent(in) :: row
      !! row of the table
      integer, intent(in) :: storey
      !! number of the storey, for a key with '{i}'
      real(wp), intent(in) :: value
      character(*), intent(in) :: text

      if (n == size(items)) call resize(items, n, 2*n)
      n = n + 1
      items(n)%key = trim(numbered(trim(row%key), storey))
      items(n)%kind = trim(row%kind)
      if (items(n)%kind == 'int' .or. items(n)%kind == 'logical') then
         items(n)%count = int(value, i8)
      else
         items(n)%number = value
      end if
      items(n)%text = text
   end subroutine append_item

   !> Resize the list; the texts are moved, not copied.
   pure subroutine resize(items, n, new_size)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      integer, intent(in) :: n
      !! number of items in use
      integer, intent(in) :: new_size
      !! >= n
      type(summary_item_t), allocatable :: resized(:)
      integer :: i

      allocate (resized(new_size))
      do i = 1, n
         resized(i)%number = items(i)%number
         resized(i)%count = items(i)%count
         call move_alloc(items(i)%key, resized(i)%key)
         call move_alloc(items(i)%kind, resized(i)%kind)
         call move_alloc(items(i)%text, resized(i)%text)
      end do
      call move_alloc(resized, items)
   end subroutine resize

   !> Write the summary without its numbers, as lines `key<TAB>kind<TAB>text`.
   pure subroutine summary_text(items, text)
      type(summary_item_t), intent(in) :: items(:)
      character(:), allocatable, intent(out) :: text
      !! lines, each with its line feed
      type(text_buffer_t) :: lines
      integer :: i

      call clear(lines)
      do i = 1, size(items)
         call append(lines, items(i)%key//tab//items(i)%kind//tab//items(i)%text//new_line('a'))
      end do
      text = lines%room(:lines%length)
   end subroutine summary_text

   !> Names of the simulated effects, in the order of the case file's groups.
   function list_effects(case) result(names)
      type(case_t), intent(in) :: case
      character(12), allocatable :: names(:)
      !! (effects)

      call list_groups(case, .true., names)
   end function list_effects

   !> Names of the effects that the scene does not use.
   function list_absent_effects(case) result(names)
      type(case_t), intent(in) :: case
      character(12), allocatable :: names(:)
      !! (effects)

      call list_groups(case, .false., names)
   end function list_absent_effects

   !> List the groups of the scene that are present, or those absent; groups with further keys
   !> appear once.
   subroutine list_groups(case, is_present, names)
      type(case_t), intent(in) :: case
      logical, intent(in) :: is_present
      character(12), allocatable, intent(out) :: names(:)
      type(case_group_t), allocatable :: groups(:)
      integer :: i

      groups = all_groups()
      allocate (names(0))
      do i = 1, size(groups)
         if (.not. groups(i)%is_of_scene .or. any(groups(:i - 1)%name == groups(i)%name)) cycle
         if (groups(i)%is_present(case) .eqv. is_present) names = &
            [character(12) :: names, groups(i)%name]
      end do
   end subroutine list_groups

   !> Length of the items of a list separated by tabs.
   pure integer function joined_length(list) result(length)
      character(*), intent(in) :: list(:)
      integer :: i

      length = max(0, size(list) - 1)
      do i = 1, size(list)
         length = length + len_trim(list(i))
      end do
   end function joined_length

   !> Join the items of a list with tabs.
   pure function joined(list) result(text)
      character(*), intent(in) :: list(:)
      !! (n), padded with blanks, which are dropped
      character(joined_length(list)) :: text
      integer :: last
      integer :: i

      last = 0
      do i = 1, size(list)
         if (i > 1) text(last + 1:last + 1) = tab
         if (i > 1) last = last + 1
         text(last + 1:last + len_trim(list(i))) = list(i)
         last = last + len_trim(list(i))
      end do
   end function joined

end module rwmf_output_summary
