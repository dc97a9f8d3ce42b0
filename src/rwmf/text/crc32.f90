!> CRC-32 of a sequence of bytes: the checksum by which an output file identifies its record.
module rwmf_text_crc32
   use, intrinsic :: iso_fortran_env, only: int32
   use rwmf_core_kinds, only: dp, i8
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: crc32

   integer(int32), parameter :: polynomial = -306674912_int32
   !! IEEE 802.3 polynomial, bits reversed: hexadecimal EDB88320

   !> CRC-32 with the IEEE polynomial, as zlib, gzip and PNG compute it: 8 lower-case hexadecimal
   !> digits.
   interface crc32
      module procedure :: crc32_of_text
      module procedure :: crc32_of_numbers
   end interface crc32

contains

   !> CRC-32 of the characters of a text, one byte each.
   pure character(8) function crc32_of_text(bytes) result(digits)
      character(*), intent(in) :: bytes
      !! the sequence
      integer(int32) :: table(0:255)
      integer(int32) :: crc
      integer :: i

      table(:) = remainders()
      crc = not(0_int32)
      do i = 1, len(bytes)
         call add_byte(table, int(ichar(bytes(i:i)), int32), crc)
      end do
      digits = digits_of(crc)
   end function crc32_of_text

   !> CRC-32 of the bytes of numbers, lowest byte first.
   pure character(8) function crc32_of_numbers(first, second) result(digits)
      real(dp), intent(in) :: first(:)
      real(dp), intent(in), optional :: second(:)
      !! appended to the first ones
      integer(int32) :: table(0:255)
      integer(int32) :: crc

      table(:) = remainders()
      crc = not(0_int32)
      call add_numbers(table, first, crc)
      if (present(second)) call add_numbers(table, second, crc)
      digits = digits_of(crc)
   end function crc32_of_numbers

   pure subroutine add_numbers(table, numbers, crc)
      integer(int32), intent(in) :: table(0:255)
      real(dp), intent(in) :: numbers(:)
      integer(int32), intent(inout) :: crc
      integer(i8) :: bits
      integer :: i
      integer :: byte

      do i = 1, size(numbers)
         bits = transfer(numbers(i), bits)
         do byte = 0, 7
            call add_byte(table, int(ibits(bits, 8*byte, 8), int32), crc)
         end do
      end do
   end subroutine add_numbers

   pure subroutine add_byte(table, byte, crc)
      integer(int32), intent(in) :: table(0:255)
      integer(int32), intent(in) :: byte
      !! 0 to 255
      integer(int32), intent(inout) :: crc

      crc = ieor(table(iand(ieor(crc, byte), 255_int32)), ishft(crc, -8))
   end subroutine add_byte

   pure character(8) function digits_of(crc) result(digits)
      integer(int32), intent(in) :: crc
      integer :: status

      write (digits, '(z8.8)', iostat=status) not(crc)
      if (status /= 0) digits = repeat('*', len(digits))
      digits = to_lower(digits)
   end function digits_of

   !> Remainder of each byte value: the lookup table of the checksum.
   pure function remainders() result(table)
      integer(int32) :: table(0:255)
      integer(int32) :: value
      integer :: bit
      integer :: byte

      do byte = 0, 255
         value = int(byte, int32)
         do bit = 1, 8
            value = ieor(ishft(value, -1), merge(polynomial, 0_int32, btest(value, 0)))
         end do
         table(byte) = value
      end do
   end function remainders

end module rwmf_text_crc32
