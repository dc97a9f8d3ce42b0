!> A recorded ground acceleration: where it comes from, and its samples when it has been read.
module rwmf_problem_record
   use rwmf_core_kinds, only: wp
   use rwmf_problem_group_values, only: get_real, get_text, group_values_t, real_of
   implicit none
   private

   public :: record_t, record_source_t, fill_source

   !> Where a record comes from.
   type :: record_source_t
      character(:), allocatable :: file
      !! path of the record as the case gives it
      character(:), allocatable :: path
      !! path of the record resolved against the folder of the namelist
      real(wp), allocatable :: dt
      !! sampling interval of a one-column record [s]
      character(:), allocatable :: unit
      !! 'g', 'm/s2' or 'cm/s2'; absent for AT2
      real(wp) :: scale
      !! factor on the record [-]
   end type record_source_t

   !> A record that has been read and checked.
   type :: record_t
      real(wp), allocatable :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), allocatable :: a(:)
      !! (n) ground acceleration, `scale` applied [m/s2]
      integer :: n
      !! number of samples, at least 2
      real(wp), allocatable :: dt
      !! sampling interval [s]; absent when it is not uniform
      real(wp) :: peak
      !! largest magnitude of the acceleration [m/s2]
      real(wp) :: t_peak
      !! its first time [s]
      character(:), allocatable :: format
      !! 'one column', 'two columns' or 'AT2'
      character(8) :: crc32
      !! of the bytes of the file, hexadecimal
   end type record_t

contains

   !> What a group of the case says about its record.
   subroutine fill_source(values, group, source)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      class(record_source_t), intent(inout) :: source

      source%scale = real_of(values, group, 'scale')
      call get_real(values, group, 'dt', source%dt)
      call get_text(values, group, 'file', source%file)
      call get_text(values, group, 'unit', source%unit)
   end subroutine fill_source

end module rwmf_problem_record
