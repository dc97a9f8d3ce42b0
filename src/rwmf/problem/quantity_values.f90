!> Values of quantities, by their numbers in the table of quantities.
!>
!> The scalars of a run, a row of its history and the sensitivities of its peaks are such lists.
module rwmf_problem_quantity_values
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_kinds, only: i8, wp
   use rwmf_problem_quantity_table, only: key_length, key_of
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: values_t, put, clear, is_present, levels_of, value_of, keys_of, numbered

   !> Values in the order in which they are put.
   type :: values_t
      integer :: n = 0
      !! number of values
      integer, allocatable :: ids(:)
      !! (at least n) numbers of their quantities
      integer, allocatable :: levels(:)
      !! (at least n) numbers of their storeys or floors from the ground up; 1 for other quantities
      real(wp), allocatable :: numbers(:)
      !! (at least n) in the units of their keys; counts unchanged, 1 for true, 0 for false
   end type values_t

   !> Append a number, a list over storeys or floors, a count, or a logical value.
   interface put
      module procedure :: put_number, put_list, put_count, put_logical
   end interface put

contains

   pure subroutine put_number(values, id, number)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: id
      !! number of the quantity
      real(wp), intent(in) :: number
      !! in the unit of its key

      call put_list(values, id, [number])
   end subroutine put_number

   pure subroutine put_list(values, id, list, below)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: id
      !! number of the quantity
      real(wp), intent(in) :: list(:)
      !! (levels) in the unit of its key
      integer, intent(in), optional :: below
      !! number of the lowest storeys or floors without a value; 0 if absent
      integer :: i, first

      call make_room(values, values%n + size(list))
      first = 0
      if (present(below)) first = below
      do i = 1, size(list)
         values%ids(values%n + i) = id
         values%levels(values%n + i) = first + i
         values%numbers(values%n + i) = list(i)
      end do
      values%n = values%n + size(list)
   end subroutine put_list

   pure subroutine put_count(values, id, count)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: id
      !! number of the quantity
      integer(i8), intent(in) :: count

      call put_list(values, id, [real(count, wp)])
   end subroutine put_count

   pure subroutine put_logical(values, id, value)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: id
      !! number of the quantity
      logical, intent(in) :: value

      call put_list(values, id, [merge(1.0_wp, 0.0_wp, value)])
   end subroutine put_logical

   !> Make room for n values.
   pure subroutine make_room(values, n)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: n
      integer, parameter :: usual = 64
      type(values_t) :: larger

      if (allocated(values%ids)) then
         if (size(values%ids) >= n) return
      end if
      allocate (larger%ids(max(usual, 2*n)), larger%levels(max(usual, 2*n)), &
         larger%numbers(max(usual, 2*n)))
      if (values%n > 0) then
         larger%ids(:values%n) = values%ids(:values%n)
         larger%levels(:values%n) = values%levels(:values%n)
         larger%numbers(:values%n) = values%numbers(:values%n)
      end if
      call move_alloc(larger%ids, values%ids)
      call move_alloc(larger%levels, values%levels)
      call move_alloc(larger%numbers, values%numbers)
   end subroutine make_room

   !> Drop all values.
   pure subroutine clear(values)
      type(values_t), intent(inout) :: values

      values%n = 0
   end subroutine clear

   !> Place of a value; 0 if it is absent.
   pure integer function place_of(values, id, level) result(place)
      type(values_t), intent(in) :: values
      integer, intent(in) :: id, level

      do place = 1, values%n
         if (values%ids(place) == id .and. values%levels(place) == max(1, level)) return
      end do
      place = 0
   end function place_of

   !> Return whether a value is present.
   elemental logical function is_present(values, id, level)
      type(values_t), intent(in) :: values
      integer, intent(in) :: id
      !! number of the quantity
      integer, intent(in) :: level
      !! number of the storey or floor; any number up to 1 for other quantities

      is_present = place_of(values, id, level) > 0
   end function is_present

   !> Value in the unit of its key; NaN if it is absent.
   elemental real(wp) function value_of(values, id, level) result(value)
      type(values_t), intent(in) :: values
      integer, intent(in) :: id, level
      !! as for `is_present`
      integer :: place

      value = ieee_value(1.0_wp, ieee_quiet_nan)
      place = place_of(values, id, level)
      if (place > 0) value = values%numbers(place)
   end function value_of

   !> Numbers of the storeys or floors with a value of a quantity; 1 for other quantities.
   pure function levels_of(values, id) result(levels)
      type(values_t), intent(in) :: values
      integer, intent(in) :: id
      !! number of the quantity
      integer, allocatable :: levels(:)

      allocate (levels(0))
      if (values%n > 0) levels = pack(values%levels(:values%n), values%ids(:values%n) == id)
   end function levels_of

   !> Keys of all values.
   pure function keys_of(values) result(keys)
      type(values_t), intent(in) :: values
      character(key_length) :: keys(values%n)
      integer :: i

      do i = 1, values%n
         keys(i) = numbered(trim(key_of(values%ids(i))), values%levels(i))
      end do
   end function keys_of

   !> Key with a number in place of '{i}'; any other key is unchanged.
   elemental character(key_length) function numbered(pattern, number) result(key)
      character(*), intent(in) :: pattern
      !! key of the table of quantities, with or without '{i}'
      integer, intent(in) :: number
      !! number that replaces '{i}'
      integer :: place

      key = pattern
      place = index(pattern, '{i}')
      if (place > 0) key = pattern(:place - 1)//trim(integer_to_text(number))//pattern(place + 3:)
   end function numbered

end module rwmf_problem_quantity_values
