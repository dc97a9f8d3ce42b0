!> CRC-32 of a sequence of bytes: the short name by which an output file identifies its record.
module rwmf_text_crc32
   use, intrinsic :: iso_fortran_env, only: int32
   implicit none
   private

   public :: crc32

   integer(int32), parameter :: polynomial = -306674912_int32
   !! IEEE 802.3 polynomial, bits reversed: hexadecimal EDB88320

contains

   !> CRC-32 with the IEEE polynomial, as zlib, gzip and PNG compute it.
   pure function crc32(bytes) result(digits)
      character(*), intent(in) :: bytes
      character(8) :: digits
      !! hexadecimal, small letters
      integer(int32) :: crc
      integer(int32) :: low
      integer(int32) :: table(0:255)
      integer :: i

      table(:) = remainders()
      crc = not(0_int32)
      do i = 1, len(bytes)
         low = iand(ieor(crc, int(ichar(bytes(i:i)), int32)), 255_int32)
         crc = ieor(table(low), ishft(crc, -8))
      end do
      digits = hexadecimal(not(crc))
   end function crc32

   !> What each value of a byte contributes.
   pure function remainders() result(table)
      integer(int32) :: table(0:255)
      integer(int32) :: value
      integer :: bit
      integer :: byte

      do byte = 0, 255
         value = int(byte, int32)
         do bit = 1, 8
            if (btest(value, 0)) then
               value = ieor(ishft(value, -1), polynomial)
            else
               value = ishft(value, -1)
            end if
         end do
         table(byte) = value
      end do
   end function remainders

   pure function hexadecimal(value) result(digits)
      integer(int32), intent(in) :: value
      character(8) :: digits
      character(16), parameter :: all_digits = '0123456789abcdef'
      integer :: digit
      integer :: i

      do i = 1, 8
         digit = ibits(value, 32 - 4*i, 4) + 1
         digits(i:i) = all_digits(digit:digit)
      end do
   end function hexadecimal

end module rwmf_text_crc32
