!> Samples of a ground acceleration from a file or an array. With unit, scale and interval of the
!> case they form a record.
module rwmf_input_record_samples
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_unit_names, only: unit_t
   use rwmf_text_crc32, only: crc32
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: samples_t, samples_from_array, set_unit

   !> Samples after a check of each number.
   type :: samples_t
      real(dp), allocatable :: a(:)
      !! (n) accelerations [unit of the record]
      real(dp), allocatable :: t(:)
      !! (n) strictly increasing times [s]; absent if an interval gives them
      real(dp), allocatable :: dt
      !! interval given by the source of the samples [s]
      integer :: dt_line = 0
      !! line of the file with the interval, 0 for none
      character(:), allocatable :: unit
      !! 'g', 'm/s2' or 'cm/s2'; absent if the source gives none
      character(:), allocatable :: unit_text
      !! unit as in the source
      logical :: is_converted = .false.
      !! the source has another unit than 'g', 'm/s2' and 'cm/s2'
      integer :: unit_line = 0
      !! line of the file with the unit, 0 for none
      character(:), allocatable :: name
      !! of the column in a table; '' without a name
      character(:), allocatable :: format
      !! 'one column', 'two columns', 'table', 'AT2' or 'array'
      character(8) :: crc32
      !! checksum of the bytes of the file, or of the numbers, hexadecimal
   end type samples_t

contains

   !> Make samples from an array, under the same rules as for a file.
   !>
   !> Errors: a number that is not finite, times that do not increase, arrays of different lengths.
   subroutine samples_from_array(a, samples, error, t)
      real(dp), intent(in) :: a(:)
      !! (n) accelerations [unit of the record]
      type(samples_t), intent(out) :: samples
      type(error_t), allocatable, intent(out) :: error
      real(dp), intent(in), optional :: t(:)
      !! (n) strictly increasing times [s]; absent if the case gives the interval
      integer :: i

      samples%format = 'array'
      samples%a = a
      call check_finite('acceleration', a, error)
      if (present(t) .and. .not. allocated(error)) then
         samples%t = t
         if (size(t) /= size(a)) then
            call fail(error, err_input, trim(integer_to_text(size(a)))//' accelerations at ' &
               //trim(integer_to_text(size(t)))//' times: must be as many')
            return
         end if
         call check_finite('time', t, error)
         do i = 2, size(t)
            if (allocated(error)) exit
            if (t(i) > t(i - 1)) cycle
            call fail(error, err_input, 'sample '//trim(integer_to_text(i))//': time '//trim( &
               real_to_text(real(t(i), wp)))//' s after '//trim(real_to_text(real(t(i - 1), wp))) &
               //' s: times must increase strictly')
         end do
      end if
      if (allocated(error)) return
      if (present(t)) then
         samples%crc32 = crc32(t, a)
      else
         samples%crc32 = crc32(a)
      end if
   end subroutine samples_from_array

   !> Set the unit that a file states, and convert the samples to one of the case's three units.
   subroutine set_unit(samples, unit, text, line)
      type(samples_t), intent(inout) :: samples
      !! with accelerations in the unit of the file
      type(unit_t), intent(in) :: unit
      !! unit of an acceleration
      character(*), intent(in) :: text
      !! as in the file
      integer, intent(in) :: line
      !! its line

      samples%unit = trim(unit%base)
      samples%unit_text = text
      samples%unit_line = line
      samples%is_converted = abs(unit%times - 1) > 0 .or. abs(unit%over - 1) > 0
      if (samples%is_converted) samples%a = samples%a*unit%times/unit%over
   end subroutine set_unit

   !> Check that every number is finite.
   subroutine check_finite(what, numbers, error)
      character(*), intent(in) :: what
      real(dp), intent(in) :: numbers(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (all(ieee_is_finite(numbers))) return
      do i = 1, size(numbers)
         if (.not. ieee_is_finite(numbers(i))) exit
      end do
      call fail(error, err_input, 'sample '//trim(integer_to_text(i))//': '//what//' ' &
         //trim(real_to_text(real(numbers(i), wp)))//' is not a finite number')
   end subroutine check_finite

end module rwmf_input_record_samples
